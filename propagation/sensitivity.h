// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/room_metrics.h"
#include "earshot/audio/speech.h"
#include "earshot/propagation/late_materials.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

struct SensitivityOptions {
    audio::Bands bands = audio::Bands::octaves();  ///< those of the simulation
    /// For the speech transmission index.
    std::optional<audio::SpeechConditions> speech{};
    /// Standard errors of the derivatives; take about eight times as long as the derivatives.
    bool report_errors = true;
};

/// The energy that a pair owes to one material, per band, before and after kEarlyLimit.
struct MaterialEnergy {
    /// Share of the energy at the listener that the material reflected at least once, of what
    /// arrives until kEarlyLimit after the onset and of what arrives later. Shares of different
    /// materials overlap.
    audio::Spectrum touched_before{}, touched_after{};
    /// Mean number of reflections by the material on the way of that energy, weighted with it.
    audio::Spectrum reflections_before{}, reflections_after{};
    /// Share of the energy emitted by the source that the material absorbs (what it transmits is
    /// not absorbed where transmission is simulated), until kEarlyLimit after the emission and
    /// later. Together with air, openings, and what is left at the end, the materials make up 1. 0
    /// without rays.
    audio::Spectrum absorbed_before{}, absorbed_after{};
};

/// Derivatives of the expected metrics of a pair by the energy absorption coefficient of one
/// material, per unit of the coefficient. A metric without a value has none, nor has a band in
/// which the material absorbs everything.
struct AbsorptionDerivatives {
    /// Of the metrics of a band by the coefficient in this band; they depend on no other.
    std::vector<audio::BandMetrics> bands{};
    /// Of the single numbers by the coefficients of all bands together.
    audio::BandMetrics mid{};
    /// Of the speech transmission index by the coefficient in each band; 0 in bands that it does
    /// not use.
    std::vector<std::optional<double>> speech_bands{};
    /// By the coefficients of all bands together.
    std::optional<double> speech_transmission_index{};
};

/// What one material of the scene means to a pair.
struct MaterialSensitivity {
    MaterialEnergy energy{};
    AbsorptionDerivatives derivatives{};
    AbsorptionDerivatives standard_errors{};  ///< of these; empty if not asked for, or without rays
};

struct PairSensitivity {
    std::size_t source = 0;    ///< index into Scene::sources
    std::size_t listener = 0;  ///< index into Scene::listeners
    double time = 0.0;         ///< seconds, of the scene's animation
    /// The metrics to which the derivatives belong: as audio::energy_metrics() without replicates,
    /// so that a value is not empty for being uncertain.
    audio::RoomMetrics metrics{};
    std::vector<MaterialSensitivity> materials{};  ///< one per material of the scene
};

/// Which surface matters to a pair. The energy of a path or ray is a product in which each
/// reflection by a material stands with 1 - absorption, so its derivative is - reflections * energy
/// / (1 - absorption); those of the metrics follow by the chain rule (audio::MetricDerivatives).
/// They are those of the expected values: random decisions of the rays are weighted, and do not
/// take part. Throws Error if the pair has late energy without materials
/// (Options::report_materials) or arrivals in place of paths.
PairSensitivity pair_sensitivity(const Scene& scene,
                                 const PairResult& pair,
                                 const SensitivityOptions& options = {});

/// Area of each material of the scene at a time, square metres: one side of its triangles.
std::vector<double> material_areas(const Scene& scene, double time);

}  // namespace earshot::propagation
