// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/frustum.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::frustum {

using geometry::Plane;
using geometry::Vec3;

namespace {

Vec3 mirrored_direction(const Plane& plane, const Vec3& direction) noexcept {
    return direction - 2.0 * glm::dot(plane.normal, direction) * plane.normal;
}

}  // namespace

std::vector<Frustum> frusta_around(const Vec3& source, int pieces, int cells, double min_depth) {
    std::vector<Frustum> frusta;
    for (int face = 0; face < 6; ++face) {
        Frustum frustum;
        frustum.apex = source;
        frustum.cells = cells;
        frustum.min_depth = min_depth;
        frustum.forward = frustum.right = frustum.up = Vec3(0.0);
        frustum.forward[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
        frustum.right[(face / 2 + 1) % 3] = 1.0;
        frustum.up[(face / 2 + 2) % 3] = 1.0;
        for (int row = 0; row < pieces; ++row) {
            for (int column = 0; column < pieces; ++column) {
                const glm::dvec2 lower = {-1.0 + 2.0 * column / pieces, -1.0 + 2.0 * row / pieces};
                frustum.rect.lower = lower - kApertureSlack;
                frustum.rect.upper = lower + 2.0 / pieces + kApertureSlack;
                frusta.push_back(frustum);
            }
        }
    }
    return frusta;
}

Frustum mirrored(const Frustum& parent,
                 const Plane& plane,
                 geometry::FacetId facet,
                 const Rect& aperture) {
    Frustum child;
    child.apex = plane.mirror(parent.apex);
    child.right = mirrored_direction(plane, parent.right);
    child.up = mirrored_direction(plane, parent.up);
    child.forward = mirrored_direction(plane, parent.forward);
    child.rect = {.lower = aperture.lower - kApertureSlack,
                  .upper = aperture.upper + kApertureSlack};
    child.cells = parent.cells;
    child.starts_at_facet = true;
    child.facet = facet;
    child.side = plane.distance(parent.apex) > 0.0 ? 1.0 : -1.0;
    child.start = child.inverse_depth(plane);
    // The aperture lies on the facet, whose closest point starts the frustum.
    child.min_depth = std::max(parent.min_depth, 0.5 / child.start.max(child.rect));
    return child;
}

BoxCull::BoxCull(const Frustum& frustum, const Plane* start_plane, double slack) noexcept {
    std::size_t count = 0;
    const auto add = [&](const Vec3& normal, double offset) {
        for (int k = 0; k < 3; ++k) {
            half_spaces_.positive[k][count] = std::max(normal[k], 0.0);
            half_spaces_.negative[k][count] = std::min(normal[k], 0.0);
        }
        const double norm = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
        half_spaces_.offset[count++] = offset - slack * norm;
    };
    const auto through_apex = [&](const Vec3& normal) {
        add(normal, glm::dot(normal, frustum.apex));
    };
    through_apex(frustum.right - frustum.rect.lower.x * frustum.forward);
    through_apex(frustum.rect.upper.x * frustum.forward - frustum.right);
    through_apex(frustum.up - frustum.rect.lower.y * frustum.forward);
    through_apex(frustum.rect.upper.y * frustum.forward - frustum.up);
    if (start_plane != nullptr) {
        add(frustum.side * start_plane->normal, frustum.side * start_plane->offset);
    } else {
        through_apex(frustum.forward);
    }
}

}  // namespace earshot::frustum
