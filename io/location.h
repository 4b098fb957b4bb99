// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/locate.h"

#include <optional>
#include <span>
#include <string>

namespace earshot::io {

/// Located sources and listeners with what the result refers to.
struct LocationParts {
    const propagation::Scene& scene;  ///< as it was stated
    std::span<const propagation::MeasuredArrival> arrivals;
    const propagation::LocateResult& result;
    /// Of cross_validate_locate(); empty: not made.
    std::span<const std::optional<double>> held_out{};
};

/// JSON as `earshot calibrate --locate` writes it; docs/files.md describes its keys. The same bytes
/// for the same result.
std::string encode_location(const LocationParts& parts);

}  // namespace earshot::io
