// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <optional>
#include <string_view>
#include <vector>

namespace earshot::io {

enum class UpAxis { y, z };

/// The unit and the up axis in which a mesh file (not glTF, which is in metres with +Y up) and the
/// points that belong to it are written.
struct FileFrame {
    double metres_per_unit = 1.0;
    UpAxis up = UpAxis::y;

    bool is_default() const noexcept { return metres_per_unit == 1.0 && up == UpAxis::y; }

    /// A point of the file in metres, +Y up: (x, y, z) of a file with +Z up becomes (x, z, -y).
    geometry::Vec3 to_scene(const geometry::Vec3& point) const noexcept;
    geometry::Vec3 to_file(const geometry::Vec3& point) const noexcept;
};

/// A unit of length by the name that options and files use.
struct LengthUnit {
    std::string_view name;  ///< "mm"
    double metres = 1.0;
};

/// m, cm, mm, in, ft.
const std::vector<LengthUnit>& length_units();

/// Metres per unit; empty if no unit has that name.
std::optional<double> metres_per_unit(std::string_view name);

}  // namespace earshot::io
