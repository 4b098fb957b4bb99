// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/shaft.h"

#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/corner_signs.h"

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

using geometry::Aabb;
using geometry::Corners;
using geometry::Vec3;

namespace {

/// A corner's coordinate along an axis.
double bound(const Aabb& box, std::size_t axis, bool upper) noexcept {
    return static_cast<double>(upper ? box.upper[axis] : box.lower[axis]);
}

}  // namespace

Shaft::Shaft(const ViewerRegion& viewer, const Aabb& to, double max_abs_coordinate) noexcept
    : boxes_{viewer.begin(), viewer.end(), to}, is_point_(viewer.is_point()) {
    double scale = max_abs_coordinate;
    for (const Aabb& box : boxes_) {
        scale = std::max(scale, box.max_abs_coordinate());
    }
    // The exact tests take coordinates below geometry::kMinCoordinate as 0.
    const double margin = std::max(kMinExtent, kPlaneError * scale);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        lower_[axis] = bound(to, axis, false);
        upper_[axis] = bound(to, axis, true);
        for (const Aabb& box : boxes_) {
            lower_[axis] = std::min(lower_[axis], bound(box, axis, false));
            upper_[axis] = std::max(upper_[axis], bound(box, axis, true));
        }
        lower_[axis] -= margin;
        upper_[axis] += margin;
        add_planes(axis, (axis + 1) % 3, margin);
    }
}

// Seen along the third axis the boxes are rectangles. Where the hull of rectangles has a side that
// is parallel to no axis, it joins two corners of the same quadrant, in which its normal lies.
void Shaft::add_planes(std::size_t i, std::size_t j, double margin) noexcept {
    for (std::size_t first = is_point_ ? 1 : 0; first < 2; ++first) {
        for (std::size_t second = first + 1; second < 3; ++second) {
            const Aabb& a = boxes_[first];
            const Aabb& b = boxes_[second];
            for (const bool upper_i : {false, true}) {
                const double step_i = bound(b, i, upper_i) - bound(a, i, upper_i);
                for (const bool upper_j : {false, true}) {
                    const double step_j = bound(b, j, upper_j) - bound(a, j, upper_j);
                    // The normal (step_j, -step_i) or its opposite lies in the quadrant.
                    const double outward_i = upper_i ? step_j : -step_j;
                    const double outward_j = upper_j ? -step_i : step_i;
                    if (outward_i * outward_j > 0.0) {
                        const double sign = outward_i > 0.0 ? 1.0 : -1.0;
                        add_plane(
                            {.i = i, .j = j, .normal_i = sign * step_j, .normal_j = -sign * step_i},
                            a,
                            margin);
                    }
                }
            }
        }
    }
}

void Shaft::add_plane(SupportingPlane plane, const Aabb& through, double margin) noexcept {
    const auto along = [&](const Aabb& box) {
        return plane.normal_i * bound(box, plane.i, plane.normal_i > 0.0) +
               plane.normal_j * bound(box, plane.j, plane.normal_j > 0.0);
    };
    const double slack = (std::abs(plane.normal_i) + std::abs(plane.normal_j)) * margin;
    const double limit = std::max({along(boxes_[0]), along(boxes_[1]), along(boxes_[2])});
    // A plane that cuts off a box supports nothing once it is moved outside.
    if (limit <= along(through) + slack && plane_count_ < kMaxPlanes) {
        plane.limit = limit + slack;
        planes_[plane_count_++] = plane;
    }
}

bool Shaft::may_touch(const Aabb& box) const noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (bound(box, axis, false) > upper_[axis] || bound(box, axis, true) < lower_[axis]) {
            return false;
        }
    }
    for (std::size_t k = 0; k < plane_count_; ++k) {
        const SupportingPlane& plane = planes_[k];
        if (plane.normal_i * bound(box, plane.i, plane.normal_i < 0.0) +
                plane.normal_j * bound(box, plane.j, plane.normal_j < 0.0) >
            plane.limit) {
            return false;
        }
    }
    return true;
}

bool Shaft::may_touch(const Corners& triangle) const noexcept {
    const auto [a, b, c] = triangle;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        if (std::min({a[axis], b[axis], c[axis]}) > upper_[k] ||
            std::max({a[axis], b[axis], c[axis]}) < lower_[k]) {
            return false;
        }
    }
    for (std::size_t k = 0; k < plane_count_; ++k) {
        const SupportingPlane& plane = planes_[k];
        const auto is_before = [&](const Vec3& p) {
            return plane.normal_i * p[static_cast<int>(plane.i)] +
                       plane.normal_j * p[static_cast<int>(plane.j)] >
                   plane.limit;
        };
        if (is_before(a) && is_before(b) && is_before(c)) {
            return false;
        }
    }
    return !is_beside_plane_of(triangle);
}

bool Shaft::is_beside_plane_of(const Corners& triangle) const noexcept {
    const TrianglePlane plane(triangle);
    const int side = plane.side(boxes_[2]);
    return side != 0 && plane.side(boxes_[0]) == side && plane.side(boxes_[1]) == side;
}

}  // namespace earshot::visibility
