// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/last_reflection.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

bool may_reflect_last(const FacetIndex& index,
                      const Frustum& frustum,
                      FacetId facet,
                      const Vec3& listener,
                      double moved) noexcept {
    const Plane& plane = index.plane(facet);
    const double from = plane.distance(frustum.apex);
    const double to = plane.distance(listener);
    // Verification refuses an apex in the plane, and takes a listener up to its slack behind it.
    if (std::abs(from) <= kRounding * index.scale() || (from > 0.0 ? to < -moved : to > moved)) {
        return false;
    }
    // Where the line from the apex to the mirrored listener meets the plane. Grazing both, it is
    // known only as well as the heights are.
    const double heights = std::abs(from) + std::abs(to);
    const Vec3 point =
        frustum.apex + (std::abs(from) / heights) * (plane.mirror(listener) - frustum.apex);
    const double span = glm::distance(frustum.apex, listener) + heights;
    const double slack = moved * (4.0 + 4.0 * span / heights);
    const geometry::Aabb& box = index.box(facet);
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        if (point[k] < static_cast<double>(box.lower[axis]) - slack ||
            point[k] > static_cast<double>(box.upper[axis]) + slack) {
            return false;
        }
    }
    const Vec3 p = frustum.local(point);
    const double room = 4.0 * slack;
    return p.x >= frustum.rect.lower.x * p.z - room && p.x <= frustum.rect.upper.x * p.z + room &&
           p.y >= frustum.rect.lower.y * p.z - room && p.y <= frustum.rect.upper.y * p.z + room;
}

}  // namespace earshot::frustum
