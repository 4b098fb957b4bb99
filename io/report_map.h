// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/report.h"
#include "earshot/propagation/map_limit.h"
#include "earshot/propagation/metric_map.h"

#include <cstdint>
#include <string>
#include <vector>

namespace earshot::io {

/// Metrics over an area, for a page.
struct MapPage {
    std::string title{};
    ReportProvenance provenance{};
    const propagation::Scene& scene;
    const audio::Bands& bands;
    std::vector<std::uint32_t> default_materials{};  ///< indices of those without acoustic data
    const propagation::MetricMap& map;
    std::vector<propagation::MapLimit> limits{};
    double min_share = 1.0;  ///< of the area that is to keep each limit
    Warnings warnings{};
};

/// Values that a page holds of all sources and metrics, those of whole maps, and at least of one.
inline constexpr std::size_t kMaxReportMapValues = 400000;

/// The data of the page, the same bytes from run to run.
std::string encode_map_page(const MapPage& page);

}  // namespace earshot::io
