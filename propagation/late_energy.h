// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/mesh.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/directivity.h"
#include "earshot/propagation/material.h"
#include "earshot/propagation/pose.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// The scene at one instant, as rays see it. Owned by the caller.
struct RayScene {
    const bvh::Tree& tree;  ///< over the triangles of `mesh`
    geometry::MeshView mesh;
    std::span<const std::uint32_t> material_of_triangle;  ///< one per triangle of `mesh`
    std::span<const Material> materials;
};

struct RaySource {
    Pose pose{};
    Directivity directivity{};
};

struct RayOptions {
    std::size_t rays = 20000;
    std::uint64_t seed = 1;
    double length = 1.0;  ///< of the histograms, seconds; rays end there
    double bin = 1e-3;    ///< seconds
    /// Sound that was reflected like by a mirror (or went through), up to so many times, is left to
    /// exact paths.
    int specular_order = 4;
    /// Of the sphere about a listener that counts rays, metres; smaller where a surface is nearer.
    /// 0: 6 % of the edge of a cube of the volume visible from the source, 0.5 ... 2 m.
    double receiver_radius = 0.0;
    audio::Bands bands = audio::Bands::octaves();
    Air air{};
    bool air_absorption = true;
    bool transmission = false;       ///< rays also go through materials that transmit
    bool report_directions = false;  ///< the histograms hold EnergyHistogram::directions
};

/// Where the energy that left the source went, per band: emitted + roulette_surplus = absorbed +
/// escaped + remaining, to rounding.
struct EnergyBalance {
    audio::Spectrum emitted{}, absorbed{}, escaped{}, remaining{};
    /// Energy that random branching added to a band whose surface splits sound otherwise than the
    /// mean of all bands: expected value 0, sum over bands 0, and 0 where all bands split alike.
    audio::Spectrum roulette_surplus{};
    std::uint64_t bounces = 0;
};

struct LateEnergy {
    std::vector<audio::EnergyHistogram> listeners;  ///< one each, air absorption included
    EnergyBalance balance;                          ///< without the air
    /// Volume that is visible from the source, cubic metres: that of the cones of its rays up to
    /// their first surface, without those that hit none.
    double visible_volume = 0.0;
};

}  // namespace earshot::propagation
