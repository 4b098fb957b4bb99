// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/scenes/carving.h"
#include "earshot/scenes/models.h"

namespace earshot::scenes {

// The plan of the concert hall in metres. x runs across the hall (0 is its middle), y up (0 is the
// floor before the stage), z from the wall behind the stage (0) to the rear.
namespace plan {

inline constexpr double kHalfWidth = 10.0;
inline constexpr double kLength = 42.0;
inline constexpr double kCeiling = 15.2;  // underside of the ribs
inline constexpr double kTop = 16.0;      // bottom of the coffers
inline constexpr double kStageEdge = 12.0;
inline constexpr double kStage = 1.0;

// Stalls: rows of three sections of seats, with two aisles between them.
inline constexpr int kRows = 22;
inline constexpr double kFirstRow = 14.0;
inline constexpr double kRowPitch = 1.1;
inline constexpr int kFlatRows = 4;  // the other rows climb a step every second row
inline constexpr double kStep = 0.16;
inline constexpr double kSeatWidth = 0.62;
struct Section {
    double left = 0.0;
    int seats = 0;
};
inline constexpr Section kSections[] = {{-7.19, 5}, {-2.79, 9}, {4.09, 5}};

// Balconies along both sides and across the rear.
inline constexpr double kBalcony = 6.0;  // underside
inline constexpr double kBalconyFloor = 6.35;
inline constexpr double kParapet = 7.25;
inline constexpr double kParapetWidth = 0.15;
inline constexpr double kSideDepth = 2.4;
inline constexpr double kSideStart = 12.5;
inline constexpr double kRearStart = 32.0;

}  // namespace plan

/// Height of the stalls' floor under a row (0 is the first).
double floor_of_row(int row);

/// What the hall is made of.
struct HallMaterials {
    explicit HallMaterials(SceneDraft& draft);
    std::size_t wall = 0;
    std::size_t panelling = 0;
    std::size_t rear_wall = 0;
    std::size_t ceiling = 0;
    std::size_t coffer = 0;
    std::size_t floor = 0;
    std::size_t stage = 0;
    std::size_t balcony = 0;
    std::size_t organ = 0;
    std::size_t door = 0;
    std::size_t seat = 0;
    std::size_t bench = 0;
    std::size_t canopy = 0;
};

/// The floor, walls, ceiling and stage; `seats` as blocks become part of the floor.
Faces hall_shell(const HallMaterials& materials, Seats seats);

/// Single seats of the stalls, each a closed solid above the floor.
Faces hall_seats(const HallMaterials& materials);

/// Panels that hang over the stage.
Faces hall_canopy(const HallMaterials& materials);

}  // namespace earshot::scenes
