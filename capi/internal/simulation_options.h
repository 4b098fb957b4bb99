// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/earshot.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/simulator.h"

#include <optional>

namespace earshot::capi {

/// All options, the defaults for null. Throws Failure for what is out of range.
es_simulation_options checked_options(const es_simulation_options* options);

/// The same, but for null what runs of many receivers or repeated ones have by default: order 3 and
/// at most 200,000 rays, until T30 has this standard error.
es_simulation_options checked_options_or(const es_simulation_options* options, double rays_error);

/// Without visible sets.
propagation::Options simulator_options(const es_simulation_options& options);

/// For STI; nothing unless they are asked for.
std::optional<audio::SpeechConditions> speech_conditions(const es_simulation_options& options);

/// Reads the HRIR set of a binaural format. Throws Error if it cannot.
propagation::ResponseFormat response_format(const es_simulation_options& options);

}  // namespace earshot::capi
