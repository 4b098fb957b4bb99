// SPDX-License-Identifier: MIT
#include "earshot/scenes/carving.h"
#include "earshot/scenes/colours.h"
#include "earshot/scenes/models.h"
#include "earshot/scenes/rounded_prism.h"
#include "earshot/scenes/shapes.h"

namespace earshot::scenes {

namespace {

// Pupils face -z, where the blackboard is. Feet end above the floor by this, as on felt pads.
constexpr double kFoot = 0.01;

Faces solid(const std::vector<Vec2>& profile,
            double length,
            const Frame& frame,
            std::size_t material,
            int rounding) {
    return rounding > 0 ? rounded_prism(profile, length, frame, material, {.pieces = rounding})
                        : prism(profile, length, frame, material);
}

// Seen from the side: a bent board on two panels. The profile runs along z (to the back) and y.
Faces chair(const Vec3& at, std::size_t material, int rounding) {
    const std::vector<Vec2> profile = {{0.00, 0.00},
                                       {0.03, 0.00},
                                       {0.03, 0.42},
                                       {0.37, 0.42},
                                       {0.37, 0.00},
                                       {0.40, 0.00},
                                       {0.44, 0.80},
                                       {0.41, 0.80},
                                       {0.39, 0.45},
                                       {0.00, 0.45}};
    const Frame frame{.origin = at + Vec3(0.20, kFoot, 0.0),
                      .u = {0.0, 0.0, 1.0},
                      .v = {0.0, 1.0, 0.0},
                      .w = {-1.0, 0.0, 0.0}};
    return solid(profile, 0.40, frame, material, rounding);
}

// Seen from the front: a board on two panels.
Faces desk(const Vec3& at, double width, std::size_t material, int rounding) {
    const std::vector<Vec2> profile = {{0.00, 0.00},
                                       {0.03, 0.00},
                                       {0.03, 0.71},
                                       {width - 0.03, 0.71},
                                       {width - 0.03, 0.00},
                                       {width, 0.00},
                                       {width, 0.74},
                                       {0.00, 0.74}};
    return solid(
        profile, 0.55, {.origin = at + Vec3(-width / 2.0, kFoot, 0.0)}, material, rounding);
}

void furnish(SceneDraft& draft, int rounding) {
    const std::size_t board = draft.library_material("wood-panelling-25mm", kWood);
    const std::size_t seat = draft.library_material("seats-wooden", kGold);
    draft.take_scattering(board, "students-tablet-arm-chairs");
    draft.take_scattering(seat, "students-tablet-arm-chairs");
    Faces desks;
    Faces chairs;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 3; ++column) {
            const Vec3 at(1.55 + 2.05 * column, 0.0, 2.75 + 1.35 * row);
            append(desks, desk(at, 1.3, board, rounding));
            append(chairs, chair(at + Vec3(-0.32, 0.0, 0.62), seat, rounding));
            append(chairs, chair(at + Vec3(0.33, 0.0, 0.66), seat, rounding));
        }
    }
    append(desks, desk({4.95, 0.0, 1.05}, 1.6, board, rounding));  // the teacher's
    draft.add_geometry("desks", std::move(desks));
    draft.add_geometry("chairs", std::move(chairs));
}

}  // namespace

SceneDraft make_classroom(const ClassroomOptions& options) {
    SceneDraft draft;
    draft.name = "classroom";
    const std::size_t lining = draft.library_material("wood-panelling-16mm", kPlaster);
    const std::size_t linoleum = draft.library_material("linoleum-on-concrete", kGreen);
    const std::size_t ceiling = draft.library_material("acoustic-plaster-25mm", kGrey);
    const std::size_t glass = draft.library_material("glass-double-glazing", kGlass);
    const std::size_t door = draft.library_material("door-solid-wood", kDarkWood);
    const std::size_t slate = draft.library_material("steel", kGreen);
    const std::size_t cupboard = draft.library_material("plywood-10mm", kWood);
    // Shelves, pictures, jackets on their hooks: what stands and hangs at the walls, metres deep.
    constexpr double kFittings = 0.15;
    draft.set_structure(lining, kFittings);
    draft.set_structure(cupboard, kFittings);

    const Box room{{0.0, 0.0, 0.0}, {7.2, 3.2, 9.0}};
    Carving walls(lining);
    walls.carve(room);
    walls.paint(room, linoleum, Facing::up);
    walls.paint(room, ceiling, Facing::down);
    for (int window = 0; window < 3; ++window) {
        const double z = 1.1 + 2.6 * window;
        const Box recess{{-0.18, 0.95, z}, {0.0, 2.75, z + 1.9}};
        walls.carve(recess);
        walls.paint(recess, lining);
        walls.paint({recess.low, {-0.18, 2.75, z + 1.9}}, glass, Facing::right);
    }
    const Box doorway{{7.2, 0.0, 7.6}, {7.26, 2.05, 8.55}};
    walls.carve(doorway);
    walls.paint({{7.26, 0.0, 7.6}, doorway.high}, door, Facing::left);
    const Box blackboard{{1.6, 0.9, 0.0}, {5.3, 2.2, 0.05}};
    walls.fill(blackboard);
    walls.paint(blackboard, slate);
    const Box cupboards{{1.2, 0.0, 8.45}, {4.8, 1.9, 9.0}};
    walls.fill(cupboards);
    walls.paint(cupboards, cupboard);
    draft.add_geometry("room", walls.surface());
    if (options.furnished) {
        furnish(draft, options.rounding);
    }

    draft.add_source("teacher", {3.27, 1.63, 1.14});
    draft.add_listener("front_left", {1.25, 1.19, 3.63});
    draft.add_listener("middle", {3.91, 1.17, 6.41});
    draft.add_listener("back_right", {5.98, 1.21, 7.73});
    return draft;
}

}  // namespace earshot::scenes
