// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/calibration.h"

#include <cstdint>
#include <span>
#include <string>

namespace earshot::io {

/// A calibration with what it refers to.
struct CalibrationParts {
    const propagation::Scene& scene;  ///< as it was before
    const audio::Bands& bands;
    const propagation::CalibrationResult& result;
    std::span<const std::uint32_t> default_materials{};  ///< indices: without acoustic data
};

/// The calibrated materials as a SCENE.materials.json, which read_material_assignments() reads: all
/// materials of the scene that were fitted or have data, by their names.
std::string encode_calibrated_materials(const CalibrationParts& parts);

/// JSON as `earshot calibrate --json` prints it; docs/files.md describes its keys. The same bytes
/// for the same result.
std::string encode_calibration(const CalibrationParts& parts);

}  // namespace earshot::io
