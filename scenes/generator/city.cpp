// SPDX-License-Identifier: MIT
#include "earshot/base/random.h"
#include "earshot/scenes/carving.h"
#include "earshot/scenes/colours.h"
#include "earshot/scenes/models.h"

#include <cmath>
#include <cstdint>

namespace earshot::scenes {

namespace {

constexpr int kPlots = 12;  // in a row
constexpr double kPlot = 20.0;
constexpr double kStorey = 3.5;
constexpr int kMaxStoreys = 11;

/// What stands on a plot: 12 to 15 m wide with a street around it, of 3 to 11 storeys.
Box building(int i, int k) {
    const auto plot = static_cast<std::uint64_t>(kPlots * i + k);
    const auto whole = [&](std::uint64_t what, double low, double high) {
        return std::floor(random_between(1, what, plot, low, high));
    };
    const Vec3 low(kPlot * i + whole(0, 2.0, 4.99), 0.0, kPlot * k + whole(1, 2.0, 4.99));
    // Most are low and some are towers.
    const double storeys =
        3.0 + std::floor((kMaxStoreys - 2.01) * std::pow(random(1, 4, plot), 2.0));
    return {low, {low.x + whole(2, 12.0, 15.99), kStorey * storeys, low.z + whole(3, 12.0, 15.99)}};
}

}  // namespace

// Twelve by twelve buildings, but for one in the middle where a square is, under a sky that lets
// all sound go. Every facade is divided into storeys and two halves.
SceneDraft make_city() {
    SceneDraft draft;
    draft.name = "city";
    const std::size_t facade = draft.library_material("concrete-smooth", kConcrete);
    const std::size_t ground = draft.library_material("gravel", kGrey);
    const std::size_t sky = draft.library_material("opening", kPlaster);
    draft.materials[sky].in_picture = false;

    const double size = kPlots * kPlot;
    const double height = kStorey * (kMaxStoreys + 1);
    const Box air{{0.0, 0.0, 0.0}, {size, height, size}};
    Carving city(facade);
    city.carve(air);
    for (int i = 0; i < kPlots; ++i) {
        for (int k = 0; k < kPlots; ++k) {
            const Box solid = building(i, k);
            if (i != kPlots / 2 || k != kPlots / 2) {
                city.fill(solid);
            }
            if (i == k) {
                city.divide(0, 0.5 * (solid.low.x + solid.high.x));
                city.divide(2, 0.5 * (solid.low.z + solid.high.z));
            }
        }
    }
    for (int storey = 1; storey <= kMaxStoreys; ++storey) {
        city.divide(1, kStorey * storey);
    }
    city.paint({{0.0, 0.0, 0.0}, {size, 0.0, size}}, ground, Facing::up);
    city.paint({{0.0, height, 0.0}, {size, height, size}}, sky);
    for (const double side : {0.0, size}) {
        city.paint({{side, 0.0, 0.0}, {side, height, size}}, sky);
        city.paint({{0.0, 0.0, side}, {size, height, side}}, sky);
    }
    draft.add_geometry("city", city.surface());
    draft.add_source("square_source", {131.3, 1.6, 128.9});
    draft.add_listener("square_listener", {126.4, 1.7, 132.7});
    return draft;
}

}  // namespace earshot::scenes
