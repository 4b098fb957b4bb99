// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/late_errors.h"
#include "earshot/propagation/late_materials.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace earshot::propagation {

enum class PathKind { direct, specular, transmitted, diffracted };

/// The name of a kind in paths.json.
std::string_view name_of(PathKind kind) noexcept;

/// One way of sound from a source to a listener.
struct Path {
    PathKind kind = PathKind::direct;
    int order = 0;                         ///< of interactions: reflections, transmissions, edges
    double length = 0.0;                   ///< metres
    double delay = 0.0;                    ///< seconds since emission
    std::vector<geometry::Vec3> points{};  ///< source, interactions, listener
    std::vector<geometry::TriangleId>
        triangles{};                         ///< of the scene in file order, one per interaction
    std::vector<std::uint32_t> materials{};  ///< index into Scene::materials, one per interaction
    /// 1 for each interaction that transmits; empty if none does.
    std::vector<std::uint8_t> transmitted{};
    /// Linear amplitude per band, spreading, air and the source's directivity included; negative in
    /// every band where the source radiates with the other sign.
    audio::Spectrum pressure{};
    /// Of a diffracted path: end points of the part of each edge that takes part, in order.
    std::vector<std::array<geometry::Vec3, 2>> edges{};
    /// Of a diffracted path: the pressure's parts per band, each with its sign. They arrive
    /// together and each has a minimum phase, which their sum need not have; `pressure` is the
    /// absolute value of the sum.
    std::vector<audio::Spectrum> parts{};
    geometry::Vec3 departure{0.0};  ///< unit direction of travel at the source
    geometry::Vec3 arrival{0.0};    ///< unit direction of travel at the listener
};

/// What one listener gets from one source.
struct PairResult {
    std::size_t source = 0;    ///< index into Scene::sources
    std::size_t listener = 0;  ///< index into Scene::listeners
    /// Tells the pair by the names of both, whatever else the scene holds: the noise that stands
    /// for late sound is drawn for it (pair_key()).
    std::uint64_t key = 0;
    double time = 0.0;          ///< seconds, of the scene's animation
    std::vector<Path> paths{};  ///< sorted by delay, order, triangles
    /// Of the paths, in their order, if Options::report_paths is off and there are no paths here.
    std::vector<audio::Arrival> arrivals{};
    /// With diffraction: what the expected metrics take for arrivals(), see energy_arrivals_of().
    std::vector<audio::Arrival> energy_arrivals{};
    /// What arrives besides, past Options::specular_order or scattered; empty without rays.
    audio::EnergyHistogram late{};
    LateErrors late_errors{};                      ///< of that
    audio::HistogramReplicates late_replicates{};  ///< of `late`; empty without rays
    LateMaterials late_materials{};  ///< of `late`; empty unless Options::report_materials
    double visible_volume = 0.0;     ///< of the source, cubic metres; see LateEnergy
};

/// The arrivals of a pair's paths, in their order; PairResult::arrivals where there are no paths.
std::vector<audio::Arrival> arrivals_of(const PairResult& pair);

/// The arrivals whose energies add up to the expected energy. These are arrivals_of() but for
/// diffracted sound, which adds to the pressure of the specular path that it mends where both
/// arrive as one.
std::vector<audio::Arrival> energy_arrivals_of(const PairResult& pair);

}  // namespace earshot::propagation
