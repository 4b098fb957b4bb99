// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/propagation/locate.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

struct ArrivalTable {
    std::vector<propagation::MeasuredArrival> arrivals{};
    Warnings warnings{};  ///< of pairs that the scene does not have: left out
};

/// Reads a table of measured arrivals: source, listener, surfaces and time in seconds between
/// commas, or the same without surfaces; a first line without a number is a header. Throws Error
/// naming the file and line.
ArrivalTable read_arrivals(const std::filesystem::path& file, const propagation::Scene& scene);

/// The surfaces of an arrival as text: `direct`, or names with `>` between them, in order; empty:
/// not known.
std::optional<std::vector<std::string>> parse_surfaces(std::string_view text);

/// The other way round, of the triangles that reflect a path: names of their materials.
std::string surfaces_text(const propagation::Scene& scene,
                          std::span<const geometry::TriangleId> triangles);

}  // namespace earshot::io
