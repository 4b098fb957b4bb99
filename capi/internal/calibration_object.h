// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/capi/internal/object_table.h"
#include "earshot/propagation/calibration.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace earshot::capi {

/// A calibration and its views. Never changes.
struct CalibrationObject : ObjectOf<ES_KIND_CALIBRATION> {
    static constexpr std::size_t kTables = ES_CALIBRATION_SCATTERING_IDENTIFIED + 1;

    explicit CalibrationObject(propagation::CalibrationResult calibration);

    propagation::CalibrationResult result;
    std::vector<propagation::Material> materials{};  // calibrated
    std::vector<bool> is_fitted;                     // per material, in some band
    Warnings warnings{};                             // of the measurements, then of the fit
    std::string json{}, materials_file{};
    std::array<std::vector<double>, kTables> tables{};  // (materials, bands)
    std::vector<double> measured, before, after, weights;
};

}  // namespace earshot::capi
