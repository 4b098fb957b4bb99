// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/propagation/trajectory.h"

#include <filesystem>
#include <string>
#include <vector>

namespace earshot::io {

/// Reads a table of points: three columns x, y, z in metres between commas, a line each. A first
/// line without a number is a header; blank lines are skipped. Throws Error naming the file and
/// line, or if there is no point or a coordinate is beyond kMaxCoordinate.
std::vector<geometry::Vec3> read_points(const std::filesystem::path& file);

/// A point of a table that has names.
struct NamedPosition {
    std::string name;
    geometry::Vec3 position{0.0};
};

/// The same of four columns: name, x, y, z. Throws Error besides if a name is empty.
std::vector<NamedPosition> read_named_points(const std::filesystem::path& file);

/// The way of something that moves: time in seconds, x, y, z. Throws Error besides if a time is no
/// number.
std::vector<propagation::TrajectoryKey> read_trajectory(const std::filesystem::path& file);

}  // namespace earshot::io
