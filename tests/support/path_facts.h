// SPDX-License-Identifier: MIT
#pragma once

#include "support/image_source_oracle.h"
#include "support/path_table.h"
#include "support/shoebox_images.h"
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace earshot::support {

/// What a table or a closed form knows of a path, whoever found it.
struct PathFacts {
    std::size_t order = 0;
    double length = 0.0;                ///< metres
    std::vector<std::uint32_t> labels;  ///< of the walls met, source first
    geometry::Vec3 image{};             ///< where the listener seems to hear the source
};

/// Where a path seems to come from: `length` metres back along its last leg.
geometry::Vec3 apparent_source(std::span<const geometry::Vec3> points, double length);

std::vector<PathFacts> facts_of(std::span<const OraclePath> paths);

/// What disagrees between the paths and the closed form, one line each; empty if nothing does.
/// Lengths must agree within `relative_tolerance`, images within that times the length.
std::string disagreement(std::span<const PathFacts> paths,
                         std::span<const ShoeboxImage> images,
                         double relative_tolerance);

/// The same against a table: paths and lines must match one to one by order, walls, and length and
/// image within `tolerance` metres.
std::string disagreement(std::span<const PathFacts> paths,
                         std::span<const TabledPath> table,
                         double tolerance);

}  // namespace earshot::support
