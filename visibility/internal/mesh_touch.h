// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"

#include <optional>

namespace earshot::visibility {

// The exact tests of geometry for a triangle of a mesh.

inline bool touches(const geometry::Segment& segment,
                    const geometry::MeshView& mesh,
                    geometry::TriangleId id) noexcept {
    const auto [a, b, c] = geometry::corners(mesh, id);
    return geometry::touches(segment, a, b, c);
}
inline std::optional<double> first_touch(const geometry::Segment& segment,
                                         const geometry::MeshView& mesh,
                                         geometry::TriangleId id) noexcept {
    const auto [a, b, c] = geometry::corners(mesh, id);
    return geometry::first_touch(segment, a, b, c);
}

}  // namespace earshot::visibility
