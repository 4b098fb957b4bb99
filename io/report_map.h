// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/report.h"

#include <cstdint>
#include <string>
#include <vector>

namespace earshot::io {

/// Metrics over an area, for a page.
struct MapPage {
    std::string title{};
    ReportProvenance provenance{};
    ReportFile map{};  ///< map.json
    /// Whose walls are shown; must outlive the call.
    const propagation::Scene* scene = nullptr;
    std::vector<std::uint32_t> default_materials{};  ///< indices of those without acoustic data
    double min_share = 1.0;  ///< of the area that is to meet each limit, 0 ... 1
    Warnings warnings{};
};

/// Values that a page holds of all sources and metrics: those of whole maps, and at least of one.
inline constexpr std::size_t kMaxReportMapValues = 400000;

/// The data of the page, the same bytes from run to run. Throws Error naming the file if it is not
/// what it should be.
std::string encode_map_page(const MapPage& page);

}  // namespace earshot::io
