// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/scene_draft.h"

#include <string>
#include <vector>

namespace earshot::scenes {

struct ShoeboxOptions {
    Vec3 size{8.0, 3.5, 6.0};  ///< metres along x, y (up) and z
    double absorption = 0.2;   ///< energy coefficient of all walls
};
/// A rectangular room with a corner at the origin: 0..x, 0..y, -z..0.
SceneDraft make_shoebox(const ShoeboxOptions& options = {});

struct LRoomOptions {
    double absorption = 0.2;
};
/// An L-shaped room 6 x 6 x 3 m with three pairs of source and listener.
SceneDraft make_lroom(const LRoomOptions& options = {});

struct CoupledRoomsOptions {
    double opening = 1.2;  ///< width of the opening, metres, 0.2 ... 3.4
};
/// A live and a dead room with an opening between them.
SceneDraft make_coupled_rooms(const CoupledRoomsOptions& options = {});

struct ClassroomOptions {
    bool furnished = true;
    /// Pieces of each rounded edge of the furniture, 1 ... 100, as a CAD program exports it; 0:
    /// sharp edges. With 6 the furniture has some 67,000 triangles.
    int rounding = 0;
};
/// A classroom with windows, a door, a blackboard, desks and chairs.
SceneDraft make_classroom(const ClassroomOptions& options = {});

enum class Seats { none, blocks, individual };
struct ConcertHallOptions {
    Seats seats = Seats::individual;
};
/// A concert hall of the shoe-box type with balconies, coffers, an organ and canopy panels.
SceneDraft make_concert_hall(const ConcertHallOptions& options = {});

struct DoorOptions {
    double angle_deg = 100.0;  ///< how far the door opens, 0 ... 120
};
/// Two rooms; the door between them opens.
SceneDraft make_door(const DoorOptions& options = {});

struct CurtainOptions {
    int folds = 12;  ///< 1 ... 100
};
/// A small hall whose curtain sways and is drawn aside.
SceneDraft make_curtain(const CurtainOptions& options = {});

/// Streets between 143 buildings of many storeys, and a square.
SceneDraft make_city();

/// All scenes with their default options, in the order of scenes/README.md.
std::vector<SceneDraft> make_all();

}  // namespace earshot::scenes
