// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/base/parallel.h"
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
    /// 0: 6 % of the edge of a cube as large as the space in sight of the source, 0.5 ... 2 m.
    double receiver_radius = 0.0;
    audio::Bands bands = audio::Bands::octaves();
    Air air{};
    bool air_absorption = true;
    bool transmission = false;      ///< rays also go through materials that transmit
    bool tells_directions = false;  ///< the histograms hold EnergyHistogram::directions
};

/// What became of the energy that left the source, per band: emitted + played = absorbed + escaped
/// + left, to rounding.
struct EnergyBalance {
    audio::Spectrum emitted{}, absorbed{}, escaped{}, left{};
    /// What chance gave a band that a surface shares out otherwise than the mean of all bands: 0 in
    /// the mean, 0 in the sum over bands, and 0 where all bands scatter alike.
    audio::Spectrum played{};
    std::uint64_t bounces = 0;
};

struct LateEnergy {
    std::vector<audio::EnergyHistogram> listeners;  ///< one each, air absorption included
    EnergyBalance balance;                          ///< without the air
    /// Of the space in sight of the source, cubic metres: what its rays see before they first hit
    /// something, of those that do.
    double volume_in_sight = 0.0;
};

/// Late sound by stochastic rays (Vorlaender 2008, chapter 11): at each surface a ray loses what is
/// absorbed and goes on like from a mirror or, with the probability of the scattering coefficient,
/// in a direction after Lambert. What is scattered reaches every listener in sight directly
/// (diffuse rain); rays from mirrors count by their way through a sphere about the listener, which
/// tells the energy density without bias. Backs of one-sided materials take everything. Ray i is a
/// pure function of (seed, i), and sums run in the order of rays: the same bits for any executor.
/// Throws Error if an option is out of range.
LateEnergy trace_late_rays(const RayScene& scene,
                           const RaySource& source,
                           std::span<const geometry::Vec3> listeners,
                           const RayOptions& options = {},
                           Executor& executor = Executor::serial());

/// How long histograms of this source must be to hold a decay of about 65 dB in every band,
/// seconds, 0.05 ... 20: told by a few rays.
double late_length(const RayScene& scene,
                   const RaySource& source,
                   const RayOptions& options = {},
                   Executor& executor = Executor::serial());

}  // namespace earshot::propagation
