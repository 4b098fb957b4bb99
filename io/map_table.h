// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/map_limit.h"
#include "earshot/propagation/metric_map.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace earshot::io {

/// A table with a line per point: x, y, z, the width and depth of its cell (empty for given
/// points), why it has no value, and of each source and metric the value and its standard error, in
/// columns `SOURCE/METRIC` and `SOURCE/METRIC/error`.
std::string encode_map_csv(const propagation::MetricMap& map);

/// map.json: one entry of "maps" for each metric and source, as docs/files.md describes. `limits`:
/// of their metrics, with contours and shares.
std::string encode_map_json(std::string_view scene,
                            const propagation::MetricMap& map,
                            std::span<const propagation::MapLimit> limits);

}  // namespace earshot::io
