// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/triangle_distance.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// An edge, or a point.
struct Edge {
    Vec3 from{0.0}, along{0.0};
    double length_squared = 0.0;
};

/// A triangle relative to a corner of the first: points close to it then have full precision.
struct Local {
    Corners corners{};
    std::array<Edge, 3> edges{};
    Vec3 normal{0.0};
    double normal_squared = 0.0;

    Local(const Corners& triangle, const Vec3& origin) noexcept {
        for (std::size_t i = 0; i < 3; ++i) {
            corners[i] = triangle[i] - origin;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 along = triangle[(i + 1) % 3] - triangle[i];
            edges[i] = {corners[i], along, glm::dot(along, along)};
        }
        normal = glm::cross(edges[0].along, edges[1].along);
        normal_squared = glm::dot(normal, normal);
    }
};

double clamped(double value) noexcept {
    return value > 0.0 ? (value < 1.0 ? value : 1.0) : 0.0;
}

/// The parameter in [0, 1] of the point of an edge that is closest to a point.
double closest_parameter(const Edge& edge, const Vec3& point) noexcept {
    return edge.length_squared > 0.0
               ? clamped(glm::dot(point - edge.from, edge.along) / edge.length_squared)
               : 0.0;
}

class ClosestPoints {
public:
    void add_edges(const Edge& one, const Edge& other) noexcept {
        // Where the lines are closest, from cross products: Gram determinants (Ericson 2005,
        // section 5.1.9) lose twice the digits of a small angle. Of edges that are parallel but for
        // rounding any parameter that the other edge reaches will do.
        const Vec3 normal = glm::cross(one.along, other.along);
        const double normal_squared = glm::dot(normal, normal);
        const Vec3 between = other.from - one.from;
        double s = 0.0;
        if (normal_squared > 0.0) {
            s = clamped(glm::dot(glm::cross(between, other.along), normal) / normal_squared);
        }
        const Vec3 start = one.from + s * one.along;
        const double t = closest_parameter(other, start);
        const Vec3 end = other.from + t * other.along;
        const double again = closest_parameter(one, end);
        add(one.from + again * one.along, end);
    }

    /// A corner whose projection is inside the other triangle; elsewhere the edges are as close.
    void add_face(const Vec3& corner, const Local& face, bool corner_is_of_other) noexcept {
        if (!(face.normal_squared > 0.0)) {
            return;
        }
        const Vec3 w = corner - face.corners[0];
        const double to_third = glm::dot(glm::cross(face.edges[0].along, w), face.normal);
        const double to_second = glm::dot(glm::cross(face.edges[2].along, w), face.normal);
        if (!(to_third > 0.0 && to_second > 0.0 && to_third + to_second < face.normal_squared)) {
            return;
        }
        const Vec3 foot = face.corners[0] +
                          (to_second / face.normal_squared) * face.edges[0].along -
                          (to_third / face.normal_squared) * face.edges[2].along;
        if (corner_is_of_other) {
            add(foot, corner);
        } else {
            add(corner, foot);
        }
    }

    double squared = std::numeric_limits<double>::infinity();
    Vec3 on_one{0.0}, on_other{0.0};

private:
    void add(const Vec3& one, const Vec3& other) noexcept {
        const Vec3 gap = other - one;
        const double length = glm::dot(gap, gap);
        if (length < squared) {
            squared = length;
            on_one = one;
            on_other = other;
        }
    }
};

}  // namespace

// Larsen, Gottschalk, Lin and Manocha 1999, section 5: of disjoint triangles the closest points lie
// on an edge of each, or one is a corner and the other in the face.
TriangleDistance distance_of_disjoint(const Corners& one, const Corners& other) noexcept {
    const Vec3 origin = one[0];
    const Local a(one, origin);
    const Local b(other, origin);
    ClosestPoints closest;
    for (const Edge& edge : a.edges) {
        for (const Edge& other_edge : b.edges) {
            closest.add_edges(edge, other_edge);
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        closest.add_face(b.corners[i], a, true);
        closest.add_face(a.corners[i], b, false);
    }
    return {std::max(std::sqrt(closest.squared), std::numeric_limits<double>::min()),
            origin + closest.on_one,
            origin + closest.on_other};
}

TriangleDistance distance(const Corners& one, const Corners& other) noexcept {
    if (const auto shared = intersection(one, other)) {
        return {0.0, shared->from, shared->from};
    }
    return distance_of_disjoint(one, other);
}

}  // namespace earshot::collision
