// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"
#include "earshot/scenes/carving.h"
#include "earshot/scenes/colours.h"
#include "earshot/scenes/models.h"
#include "earshot/scenes/shapes.h"

namespace earshot::scenes {

namespace {

constexpr double kGap = 0.01;  // between leaf and frame, metres

glm::dquat turned_about_y(double angle) {
    return {math::cos(angle / 2.0), 0.0, math::sin(angle / 2.0), 0.0};
}

// Hangs on its hinge at the origin, in the wall (z < 0); opens towards +z.
DraftNode make_leaf(const Box& doorway, double angle, std::size_t material) {
    const Vec3 size = doorway.high - doorway.low;
    DraftNode leaf;
    leaf.name = "door";
    leaf.translation = {doorway.low.x + kGap, doorway.low.y + kGap, doorway.high.z + kGap};
    leaf.faces = box({0.0, 0.0, -0.045}, {size.x - 2.0 * kGap, size.y - 2.0 * kGap, 0.0}, material);
    // Opens in two seconds, stays, and falls shut in one.
    leaf.rotation.times = {0.0, 2.0, 3.0, 4.0};
    leaf.rotation.rotations = {
        turned_about_y(0.0), turned_about_y(-angle), turned_about_y(-angle), turned_about_y(0.0)};
    return leaf;
}

}  // namespace

SceneDraft make_door(const DoorOptions& options) {
    SceneDraft draft;
    draft.name = "door";
    const std::size_t plaster = draft.library_material("plaster-on-brick", kPlaster);
    const std::size_t parquet = draft.library_material("parquet-on-concrete", kWood);
    const std::size_t door = draft.library_material("door-solid-wood", kDarkWood);

    const Box study{{0.0, 0.0, 0.0}, {4.6, 2.7, 3.8}};
    const Box hall{{-1.3, 0.0, -5.15}, {5.4, 2.7, -0.15}};
    const Box doorway{{1.1, 0.0, -0.15}, {2.1, 2.1, 0.0}};
    Carving rooms(plaster);
    rooms.carve(study);
    rooms.carve(hall);
    rooms.carve(doorway);
    rooms.paint({{-1.3, 0.0, -5.15}, {5.4, 0.0, 3.8}}, parquet, Facing::up);
    draft.add_geometry("rooms", rooms.surface());
    draft.nodes.push_back(make_leaf(doorway, options.angle_deg * math::kPi / 180.0, door));

    draft.add_source("hall_source", {3.13, 1.55, -3.62});
    draft.add_listener("study_listener", {1.72, 1.24, 2.41});
    draft.add_listener("hall_listener", {0.37, 1.62, -1.19});
    return draft;
}

}  // namespace earshot::scenes
