// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/directivity.h"
#include "earshot/propagation/late_errors.h"
#include "earshot/propagation/late_materials.h"
#include "earshot/propagation/material.h"
#include "earshot/propagation/pose.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::propagation {

/// The scene at one instant, as rays see it. Owned by the caller.
struct RayScene {
    bvh::MeshBvh bvh;
    std::span<const std::uint32_t> material_of_triangle;  ///< one per triangle of the mesh
    std::span<const Material> materials;

    const geometry::MeshView& mesh() const noexcept { return bvh.mesh(); }
};

struct RaySource {
    Pose pose{};
    Directivity directivity{};
};

struct RayOptions {
    std::size_t rays = 20000;  ///< with `max_error`: at most
    /// Batches are traced until 1.3 standard errors of T30 at 500 Hz and 1 kHz are below this share
    /// of it, and those of the level below 0.05 dB for each per cent of it; looked at after 16
    /// batches of 2,048 rays (there 2 in place of 1.3), 32, 48, 64, 96, ... Each listener has the
    /// batches up to its own end. 0: all rays.
    double max_error = 0.0;
    std::uint64_t seed = 1;
    double length = 1.0;  ///< of the histograms, seconds; rays end there
    double bin = 1e-3;    ///< seconds
    /// Sound that was reflected like by a mirror (or went through), up to so many times, is left to
    /// exact paths.
    int specular_order = 4;
    /// Of the ball about a listener that counts rays, metres. A wider ball counts more rays; in
    /// rooms that are not convex, long chains of reflections count with the energy of the ball in
    /// place of the listener's. In large spaces the ball for rays that were scattered is larger, up
    /// to 1.5 m.
    double receiver_radius = 1.0;
    /// Seconds in which the sound decays by 60 dB, roughly: rays that are faint compared with that
    /// decay end by Russian roulette. 0: unknown.
    double decay_time = 0.0;
    audio::Bands bands = audio::Bands::octaves();
    Air air{};
    bool air_absorption = true;
    bool transmission = false;  ///< rays also go through materials that transmit
    /// Listeners nearer than this, metres, receive all diffuse rain of a surface that faces them.
    /// The farther ones receive it with the probability of their solid angle compared with theirs,
    /// and then more of it: with listeners by the hundred that takes less time, and no more
    /// variance than the rain of nearer surfaces has. The choice for a listener depends on no
    /// other.
    double rain_radius = std::numeric_limits<double>::infinity();
    /// Rays that have become light for their time end by Russian roulette, and heavy ones are split
    /// (a weight window): T30 of listeners by the hundred takes far less time. `decay_time` counts
    /// for nothing then. The means are those of other rays.
    bool weight_window = false;
    bool report_directions = false;  ///< the histograms hold EnergyHistogram::directions
    bool report_materials = false;   ///< LateSound::materials is filled
    bool report_scattering = false;  ///< and counts scattered reflections besides
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

/// What one listener receives.
struct LateSound {
    audio::EnergyHistogram histogram{};  ///< air absorption included
    LateErrors errors{};
    /// Batches of rays, in groups of equally many successive ones. Empty with fewer than four
    /// batches; with more than 64, some of the last may be in no group.
    audio::HistogramReplicates replicates{};
    LateMaterials materials{};    ///< empty unless RayOptions::report_materials
    double visible_volume = 0.0;  ///< of the source, cubic metres; see LateEnergy
};

/// What concerns no listener.
struct LateTotals {
    EnergyBalance balance{};  ///< without the air
    /// As LateEnergy::visible_volume.
    double visible_volume = 0.0;
};

struct LateEnergy {
    std::vector<audio::EnergyHistogram> listeners;       ///< one each, see LateSound
    std::vector<LateErrors> errors;                      ///< likewise
    std::vector<audio::HistogramReplicates> replicates;  ///< likewise
    std::vector<LateMaterials> materials;  ///< likewise; empty unless RayOptions::report_materials
    EnergyBalance balance;                 ///< without the air
    /// Volume that is visible from the source, cubic metres: that of the cones of its rays up to
    /// their first surface, without those that hit none.
    double visible_volume = 0.0;
};

}  // namespace earshot::propagation
