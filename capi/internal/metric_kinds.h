// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace earshot::capi {

/// What is to be known of an es_metric whatever its value.
struct MetricKind {
    const char* key = "";
    const char* unit = "";
    double just_noticeable_difference = 0.0;
    bool relative = false;
};

/// Null for numbers that are no es_metric.
const MetricKind* metric_kind(std::int32_t metric);

}  // namespace earshot::capi
