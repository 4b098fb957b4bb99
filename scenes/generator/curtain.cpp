// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"
#include "earshot/scenes/carving.h"
#include "earshot/scenes/colours.h"
#include "earshot/scenes/models.h"

namespace earshot::scenes {

namespace {

// The cloth hangs on a rail along x; lengths in metres.
constexpr double kWidth = 7.4;
constexpr double kHeight = 3.9;
constexpr double kDrawnWidth = 1.5;
constexpr int kColumnsPerFold = 4;
constexpr int kRows = 6;

double depth_of_folds(double x, double folds, double depth) {
    return depth * math::sin(2.0 * math::kPi * folds * (x / kWidth));
}

// A single sheet of cloth: it has an edge, and sound reflects from both of its sides.
Faces sheet(int folds, std::size_t material) {
    const int columns = folds * kColumnsPerFold;
    const auto at = [&](int column, int row) {
        const double x = kWidth * column / columns;
        return Vec3(x, kHeight * row / kRows, depth_of_folds(x, folds, 0.12));
    };
    Faces faces;
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < columns; ++column) {
            faces.push_back({{at(column, row),
                              at(column + 1, row),
                              at(column + 1, row + 1),
                              at(column, row + 1)},
                             4,
                             material});
        }
    }
    return faces;
}

DraftNode make_cloth(int folds, std::size_t material) {
    DraftNode cloth;
    cloth.name = "curtain";
    cloth.translation = {-3.75, 0.06, -1.3};
    cloth.faces = sheet(folds, material);
    // Blown by a draught: the hem moves most.
    cloth.morphs.emplace_back([](const Vec3& at) {
        const double slack = 1.0 - at.y / kHeight;
        return Vec3(
            0.0, 0.08 * slack * slack, 0.55 * slack * slack * (0.6 + 0.4 * math::sin(1.3 * at.x)));
    });
    // Drawn to one side: narrower, with deeper folds.
    cloth.morphs.emplace_back([folds](const Vec3& at) {
        return Vec3(at.x * (kDrawnWidth / kWidth - 1.0), 0.0, depth_of_folds(at.x, folds, 0.22));
    });
    cloth.weights.times = {0.0, 0.7, 1.4, 2.1, 2.8, 5.0};
    cloth.weights.weights = {
        {0.0, 0.0}, {1.0, 0.0}, {-0.6, 0.0}, {0.3, 0.0}, {0.0, 0.0}, {0.0, 1.0}};
    return cloth;
}

}  // namespace

SceneDraft make_curtain(const CurtainOptions& options) {
    SceneDraft draft;
    draft.name = "curtain";
    const std::size_t plaster = draft.library_material("plaster-on-brick", kPlaster);
    const std::size_t floor = draft.library_material("wood-floor-on-joists", kWood);
    const std::size_t stage = draft.library_material("wood-stage-floor", kDarkWood);
    const std::size_t velour = draft.library_material("curtain-heavy", kRed);

    // A hall for small plays: the stage, 0.6 m high, lies behind the curtain.
    const Box hall{{-5.0, -0.6, -5.2}, {5.0, 4.4, 8.6}};
    const Box podium{{-5.0, -0.6, -5.2}, {5.0, 0.0, -0.4}};
    Carving room(plaster);
    room.carve(hall);
    room.fill(podium);
    room.fill({{-5.0, 0.0, -1.6}, {-3.9, 4.4, -1.0}});  // piers beside the curtain, and the lintel
    room.fill({{3.8, 0.0, -1.6}, {5.0, 4.4, -1.0}});
    room.fill({{-3.9, 4.05, -1.6}, {3.8, 4.4, -1.0}});
    room.paint(hall, floor, Facing::up);
    room.paint(podium, stage);
    draft.add_geometry("hall", room.surface());
    draft.nodes.push_back(make_cloth(options.folds, velour));

    draft.add_source("stage_source", {0.43, 1.52, -3.37});
    draft.add_listener("front_listener", {-1.27, 0.62, 2.61});
    draft.add_listener("back_listener", {2.16, 0.61, 7.13});
    return draft;
}

}  // namespace earshot::scenes
