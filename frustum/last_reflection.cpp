// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/last_reflection.h"

#include "earshot/bvh/traverse.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Plane;
using geometry::Vec3;

std::span<const LastReflection> LastReflections::find(const Frustum& frustum,
                                                      std::span<const Vec3> listeners) {
    found_.clear();
    // As far as PathVerifier takes rounding to reach, and more.
    const double moved =
        4.0 * kRounding * (index_.scale() + listener_reach_ + glm::length(frustum.apex));
    const Plane* start_plane = frustum.starts_at_facet ? &index_.plane(frustum.facet) : nullptr;
    const BoxCull cull(frustum, start_plane, moved);
    bvh::traverse(
        index_.tree(),
        [&](const bvh::Node& node) { return cull.may_meet(node.box); },
        [&](FacetId facet) {
            if (frustum.starts_at_facet && facet == frustum.facet) {
                return true;
            }
            for (std::size_t i = 0; i < listeners.size(); ++i) {
                if (may_reflect(frustum, facet, listeners[i], moved)) {
                    found_.push_back({facet, i});
                }
            }
            return true;
        });
    return found_;
}

bool LastReflections::may_reflect(const Frustum& frustum,
                                  FacetId facet,
                                  const Vec3& listener,
                                  double moved) const noexcept {
    const Plane& plane = index_.plane(facet);
    const double from = plane.distance(frustum.apex);
    const double to = plane.distance(listener);
    // Verification refuses an apex in the plane, and takes a listener up to its slack behind it.
    if (std::abs(from) <= kRounding * index_.scale() || (from > 0.0 ? to < -moved : to > moved)) {
        return false;
    }
    // Where the line from the apex to the mirrored listener meets the plane. Grazing both, it is
    // known only as well as the heights are.
    const double heights = std::abs(from) + std::abs(to);
    const Vec3 point =
        frustum.apex + (std::abs(from) / heights) * (plane.mirror(listener) - frustum.apex);
    const double span = glm::distance(frustum.apex, listener) + heights;
    const double slack = moved * (4.0 + 4.0 * span / heights);
    const geometry::Aabb& box = index_.box(facet);
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
