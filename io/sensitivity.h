// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/propagation/scene.h"
#include "earshot/propagation/sensitivity.h"

#include <span>
#include <string>
#include <vector>

namespace earshot::io {

/// What sensitivity.json says about the run as a whole.
struct SensitivityHeader {
    const propagation::Scene& scene;
    const audio::Bands& bands;
    std::span<const double> areas;  ///< of each material, see propagation::material_areas()
};

/// The text of sensitivity.json: per pair what each material means to it. A derivative that there
/// is not is null.
std::string encode_sensitivity(const SensitivityHeader& header,
                               const std::vector<propagation::PairSensitivity>& pairs);

}  // namespace earshot::io
