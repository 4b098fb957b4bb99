// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/error.h"
#include "earshot/propagation/calibration.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace earshot::io {

/// Metrics that were measured in a room, and what of the files was odd.
struct MeasuredMetrics {
    std::vector<propagation::MeasuredMetric> values{};
    Warnings warnings{};
};

/// Indices into audio::kBandMetricKinds of keys between commas, "edt,t30". Throws Error naming a
/// key that is none, or that stands twice.
std::vector<std::size_t> parse_metric_keys(std::string_view text);

/// Reads a table: the columns source, listener, metric ("t30"), band (its nominal frequency,
/// hertz), value and, if known, its standard error, a line each. A first line without a number is a
/// header; blank lines and rows without a value are skipped. Other metrics than `kinds` (all, if it
/// is empty) are left out, and so are pairs that the scene does not have, with a warning. Throws
/// Error naming the file and line.
MeasuredMetrics read_measured_table(const std::filesystem::path& file,
                                    const propagation::Scene& scene,
                                    const audio::Bands& bands,
                                    std::span<const std::size_t> kinds = {});

}  // namespace earshot::io
