// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_metrics.h"
#include "earshot/propagation/calibration.h"
#include "earshot/propagation/room_shapes.h"

#include "one_material_scene.h"
#include "support/random_normal.h"
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace earshot::propagation {

inline const audio::Bands& calibration_bands() {
    return audio::Bands::octaves();
}

/// Adds a closed block with a material of its own, fronts outside.
inline void add_block(Scene& scene,
                      const std::string& name,
                      const geometry::Vec3& corner,
                      const geometry::Vec3& size) {
    geometry::Mesh mesh;
    mesh.positions = scene.mesh.positions_at(0.0);
    mesh.triangles.assign(scene.mesh.triangles().begin(), scene.mesh.triangles().end());
    const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
    const geometry::Mesh block = box_mesh(size);
    for (const geometry::Vec3& position : block.positions) {
        mesh.positions.push_back(position + corner);
    }
    for (const geometry::Triangle& t : block.triangles) {
        // The triangles of box_mesh() face the inside.
        mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
        scene.material_of_triangle.push_back(static_cast<std::uint32_t>(scene.materials.size()));
    }
    scene.materials.push_back({.name = name});
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
}

/// A coefficient per octave.
inline EnergyCoefficient per_octave(const std::vector<double>& values) {
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t band = 0; band < values.size(); ++band) {
        points.push_back({calibration_bands().nominal_hz()[band], values[band]});
    }
    return EnergyCoefficient(points);
}

/// A room of 8 x 3 x 6 m whose six walls and two blocks differ: eight materials, two sources, five
/// listeners.
inline Scene calibration_room() {
    Scene scene = shoebox_room({8.0, 3.0, 6.0});
    add_block(scene, "table", {3.0, 0.0, 2.0}, {2.0, 0.8, 1.0});
    add_block(scene, "cupboard", {0.2, 0.0, 3.5}, {0.6, 2.0, 1.6});
    constexpr std::array<double, 8> kAbsorption = {0.3, 0.6, 0.2, 0.25, 0.4, 0.3, 0.5, 0.4};
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        std::vector<double> absorption;
        for (std::size_t band = 0; band < calibration_bands().count(); ++band) {
            absorption.push_back(kAbsorption[i] * (0.7 + 0.05 * static_cast<double>(band)));
        }
        scene.materials[i].absorption = per_octave(absorption);
        scene.materials[i].scattering = EnergyCoefficient(i < 6 ? 0.2 : 0.4);
    }
    scene.sources = {{.name = "s1", .position = {1.3, 0.7, 1.1}},
                     {.name = "s2", .position = {6.4, 2.3, 4.9}}};
    const std::vector<geometry::Vec3> listeners = {
        {2.2, 1.2, 4.6}, {4.1, 2.6, 5.2}, {7.4, 0.5, 2.9}, {5.8, 1.5, 0.5}, {3.6, 1.3, 2.5}};
    for (const geometry::Vec3& position : listeners) {
        scene.listeners.push_back(
            {.name = "l" + std::to_string(scene.listeners.size() + 1), .position = position});
    }
    return scene;
}

/// A room of 9 x 3 x 7 m with a floor and a ceiling that absorb and walls that do not: sound stays
/// between the walls until they scatter it, so that decays tell how much they do. Three materials,
/// a source, four listeners.
inline Scene flutter_room() {
    Scene scene = shoebox_room({9.0, 3.0, 7.0});
    for (std::uint32_t& material : scene.material_of_triangle) {
        material = std::min(material, 2U);
    }
    scene.materials.resize(3);
    constexpr std::array<double, 3> kAbsorption = {0.5, 0.6, 0.08}, kScattering = {0.3, 0.3, 0.2};
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        scene.materials[i].absorption = EnergyCoefficient(kAbsorption[i]);
        scene.materials[i].scattering = EnergyCoefficient(kScattering[i]);
    }
    scene.materials[2].name = "walls";
    scene.sources = {{.name = "s", .position = {1.7, 1.2, 2.1}}};
    const std::vector<geometry::Vec3> listeners = {
        {5.3, 1.4, 3.2}, {7.6, 1.1, 5.7}, {3.1, 1.7, 5.9}, {6.9, 1.5, 1.4}};
    for (const geometry::Vec3& position : listeners) {
        scene.listeners.push_back(
            {.name = "l" + std::to_string(scene.listeners.size() + 1), .position = position});
    }
    return scene;
}

/// The scene with absorption that is off as priors are, drawn by `seed`.
inline Scene with_wrong_absorption(const Scene& truth, std::uint64_t seed) {
    Scene scene = truth;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const audio::Spectrum absorption = truth.materials[i].absorption.over(calibration_bands());
        std::vector<double> wrong;
        for (std::size_t band = 0; band < calibration_bands().count(); ++band) {
            wrong.push_back(std::clamp(CoefficientPrior{.mean = absorption[band]}.value_at(
                                           test::random_normal(seed, 50 + i, band)),
                                       0.005,
                                       0.95));
        }
        scene.materials[i].absorption = per_octave(wrong);
    }
    return scene;
}

/// The scene with scattering that is off as priors are, drawn by `seed`.
inline Scene with_wrong_scattering(const Scene& truth, std::uint64_t seed) {
    Scene scene = truth;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const audio::Spectrum scattering = truth.materials[i].scattering.over(calibration_bands());
        std::vector<double> wrong;
        for (std::size_t band = 0; band < calibration_bands().count(); ++band) {
            const CoefficientPrior about = {.of = Coefficient::scattering,
                                            .mean = scattering[band]};
            wrong.push_back(about.value_at(test::random_normal(seed, 150 + i, band)));
        }
        scene.materials[i].scattering = per_octave(wrong);
    }
    return scene;
}

/// Expected metrics of every pair, with standard errors where there are rays.
inline std::vector<audio::RoomMetrics> expected_metrics(const Scene& scene,
                                                        const Options& options) {
    std::vector<audio::RoomMetrics> metrics;
    for (const PairResult& pair : Simulator(scene, options).run()) {
        metrics.push_back(audio::energy_metrics(options.bands, arrivals_of(pair), pair.late));
        metrics.back().standard_error =
            audio::energy_metrics(
                options.bands, arrivals_of(pair), pair.late, {.replicates = &pair.late_replicates})
                .standard_error;
    }
    return metrics;
}

/// Measurements of every pair and the given metrics and bands: the values of `truth` with errors of
/// the standard errors of `noise`, drawn by `seed`; without noise if it is 0.
inline std::vector<MeasuredMetric> measured_metrics(const Scene& scene,
                                                    const std::vector<audio::RoomMetrics>& truth,
                                                    const std::vector<audio::RoomMetrics>& noise,
                                                    const std::vector<std::size_t>& kinds,
                                                    const std::vector<std::size_t>& bands,
                                                    std::uint64_t seed) {
    std::vector<MeasuredMetric> measured;
    for (std::size_t pair = 0; pair < truth.size(); ++pair) {
        for (const std::size_t kind : kinds) {
            for (const std::size_t band : bands) {
                const auto metric = audio::kBandMetricKinds[kind].value;
                const auto value = truth[pair].bands[band].*metric;
                const auto error = noise[pair].standard_error.bands[band].*metric;
                if (value && error && *error > 0.0) {
                    const double step =
                        seed == 0 ? 0.0
                                  : *error * test::random_normal(seed, 1 + kind, 100 * pair + band);
                    measured.push_back({.source = pair / scene.listeners.size(),
                                        .listener = pair % scene.listeners.size(),
                                        .kind = kind,
                                        .band = band,
                                        .value = *value + step,
                                        .error = *error});
                }
            }
        }
    }
    return measured;
}

}  // namespace earshot::propagation
