// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <optional>
#include <string>

namespace earshot::audio {

/// A remark on a metric: why it has no value, or what its value is of.
struct MetricNote {
    std::string metric;               ///< its key in metrics.json, "t30"; "all": every metric
    std::optional<double> band_hz{};  ///< nominal; empty where no single band is meant
    std::string text{};

    friend bool operator==(const MetricNote&, const MetricNote&) = default;
};

}  // namespace earshot::audio
