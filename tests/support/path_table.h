// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <cstdint>
#include <string>
#include <vector>

namespace earshot::support {

/// One line of a table in tests/data/paths.
struct TabledPath {
    int order = 0;
    double time = 0.0;                 ///< seconds at 343.0 m/s
    double length = 0.0;               ///< metres
    std::vector<std::uint32_t> walls;  ///< source first, numbered as plan_room() labels them
    geometry::Vec3 image{};            ///< mirrored source, turned into the library's frame
};

/// Reads tests/data/paths/NAME. Throws std::runtime_error if the file is absent or a line does not
/// have the nine columns.
std::vector<TabledPath> read_path_table(const std::string& name);

}  // namespace earshot::support
