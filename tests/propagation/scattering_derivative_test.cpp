// SPDX-License-Identifier: MIT
// Derivatives of late energy by scattering coefficients, from counts of scattered reflections,
// against full runs with other coefficients.
#include "earshot/base/standard_error.h"
#include "earshot/propagation/internal/pair_energies.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace earshot::propagation {
namespace {

constexpr std::size_t kBand = 5;

const audio::Bands& bands() {
    return audio::Bands::octaves();
}

/// Coefficients that differ by band where `by_band` says so, so that rays are weighted.
EnergyCoefficient coefficient(double value, bool by_band) {
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t band = 0; band < bands().count(); ++band) {
        const double factor = by_band ? 0.7 + 0.06 * static_cast<double>(band) : 1.0;
        points.push_back({bands().nominal_hz()[band], factor * value});
    }
    return EnergyCoefficient(points);
}

/// A box with a listener near a wall, which reversed rays reach.
Scene test_room(bool by_band) {
    Scene scene = shoebox_room({7.0, 3.0, 5.0});
    constexpr std::array<double, 6> kAbsorption = {0.5, 0.6, 0.08, 0.12, 0.1, 0.15};
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        scene.materials[i].absorption = EnergyCoefficient(kAbsorption[i]);
        scene.materials[i].scattering = coefficient(i < 2 ? 0.1 : 0.25, by_band);
    }
    scene.sources.push_back({.name = "s", .position = {1.7, 1.5, 2.1}});
    scene.listeners.push_back({.name = "near a wall", .position = {5.9, 1.2, 4.6}});
    return scene;
}

Options options_for(std::uint64_t seed) {
    return {.specular_order = 2,
            .air_absorption = false,
            .rays = 8192,
            .seed = seed,
            .late_length = 0.6,
            .report_materials = true,
            .report_scattering = true};
}

/// Ends of the windows in which energies are compared, seconds.
constexpr std::array<double, 3> kEnds = {0.06, 0.2, 0.6};
using Windows = std::array<double, kEnds.size()>;

/// Late energy and its derivative by the scattering of one material in one band.
struct WindowEnergies {
    Windows energy{}, derivative{};
};

WindowEnergies energies_of(const Scene& scene, const Options& options, std::size_t material) {
    const PairResult pair = Simulator(scene, options).run().front();
    const LateMaterials& late = pair.late_materials;
    const PairEnergies energies(scene, pair);
    const LateMaterials::Part& all = energies.whole();
    const double scattering = scene.materials[material].scattering.over(bands())[kBand];
    WindowEnergies result;
    for (std::size_t interval = 0; interval < late.intervals(); ++interval) {
        const double begin = static_cast<double>(late.first_bin[interval]) * pair.late.bin;
        std::size_t window = 0;
        while (window + 1 < kEnds.size() && begin >= kEnds[window]) {
            ++window;
        }
        const std::size_t cell = (interval * late.materials + material) * late.bands + kBand;
        result.energy[window] += all.energy[interval * late.bands + kBand];
        result.derivative[window] +=
            all.scatterings[cell] / scattering -
            (all.reflections[cell] - all.scatterings[cell]) / (1.0 - scattering);
    }
    return result;
}

Scene with_scattering(const Scene& scene, std::size_t material, double change) {
    Scene result = scene;
    audio::Spectrum scattering = scene.materials[material].scattering.over(bands());
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t band = 0; band < bands().count(); ++band) {
        points.push_back(
            {bands().nominal_hz()[band], scattering[band] + (band == kBand ? change : 0.0)});
    }
    result.materials[material].scattering = EnergyCoefficient(points);
    return result;
}

/// Derivatives by one material's scattering are the differences of full runs, over seeds, within
/// the standard error of their difference. In units of the energy.
void expect_derivative(const Scene& scene, std::size_t material) {
    constexpr std::size_t kSeeds = 10;
    constexpr double kChange = 0.05;
    std::array<std::vector<double>, kEnds.size()> apart;
    Windows derivative{};
    for (std::size_t seed = 1; seed <= kSeeds; ++seed) {
        const Options options = options_for(seed);
        const WindowEnergies at = energies_of(scene, options, material);
        const Windows more =
            energies_of(with_scattering(scene, material, kChange), options, material).energy;
        const Windows less =
            energies_of(with_scattering(scene, material, -kChange), options, material).energy;
        for (std::size_t i = 0; i < kEnds.size(); ++i) {
            apart[i].push_back((at.derivative[i] - (more[i] - less[i]) / (2.0 * kChange)) /
                               at.energy[i]);
            derivative[i] += at.derivative[i] / at.energy[i] / kSeeds;
        }
    }
    for (std::size_t i = 0; i < kEnds.size(); ++i) {
        double mean = 0.0;
        for (const double step : apart[i]) {
            mean += step / kSeeds;
        }
        // The quantile 0.999 of Student's t with nine degrees of freedom is 4.3.
        EXPECT_LT(std::abs(mean),
                  0.05 * std::abs(derivative[i]) + 4.3 * standard_error_of_mean(apart[i]))
            << scene.materials[material].name << " until " << kEnds[i] << " s";
    }
}

TEST(ScatteringDerivative, IsTheDifferenceOfFullRuns) {
    for (const std::size_t material : {std::size_t{0}, std::size_t{4}}) {
        expect_derivative(test_room(false), material);
    }
}

TEST(ScatteringDerivative, IsTheDifferenceOfFullRunsWhereRaysAreWeighted) {
    expect_derivative(test_room(true), 3);
}

// Over a floor alone all late sound was scattered once.
TEST(ScatteringDerivative, OverAFloorCountsOneScattering) {
    Scene scene = test_room(false);
    std::vector<geometry::Triangle> floor(scene.mesh.triangles().begin(),
                                          scene.mesh.triangles().begin() + 2);
    scene.material_of_triangle.resize(2);
    scene.mesh = geometry::AnimatedMesh::fixed(
        {.positions = scene.mesh.positions_at(0.0), .triangles = std::move(floor)});
    const PairResult pair = Simulator(scene, options_for(1)).run().front();
    const PairEnergies energies(scene, pair);
    const LateMaterials::Part& all = energies.whole();
    const LateMaterials& late = pair.late_materials;
    const std::uint32_t material = scene.material_of_triangle.front();
    double sum = 0.0;
    for (std::size_t interval = 0; interval < late.intervals(); ++interval) {
        const double energy = all.energy[interval * late.bands + kBand];
        EXPECT_DOUBLE_EQ(
            all.scatterings[(interval * late.materials + material) * late.bands + kBand], energy);
        sum += energy;
    }
    EXPECT_GT(sum, 0.0);
}

TEST(ScatteringDerivative, CountingChangesNoOtherResult) {
    const Scene scene = test_room(true);
    Options options = options_for(1);
    options.rays = 2048;
    const PairResult counted = Simulator(scene, options).run().front();
    options.report_scattering = false;
    const PairResult plain = Simulator(scene, options).run().front();
    EXPECT_EQ(plain.late.energy, counted.late.energy);
    ASSERT_EQ(plain.late_materials.parts.size(), counted.late_materials.parts.size());
    for (std::size_t i = 0; i < plain.late_materials.parts.size(); ++i) {
        EXPECT_EQ(plain.late_materials.parts[i].reflections,
                  counted.late_materials.parts[i].reflections);
        EXPECT_TRUE(plain.late_materials.parts[i].scatterings.empty());
    }
}

}  // namespace
}  // namespace earshot::propagation
