// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::test {

/// The distance of a point from a segment.
inline double distance_to_segment(const geometry::Vec3& p,
                                  const geometry::Vec3& a,
                                  const geometry::Vec3& b) {
    const geometry::Vec3 along = b - a;
    const double squared = glm::dot(along, along);
    const double t = squared > 0.0 ? std::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
    return glm::length(p - (a + t * along));
}

/// The distance of a point from a triangle: from its plane where the foot of the perpendicular is
/// inside, else from its edges.
inline double distance_to_triangle(const geometry::Vec3& p, const geometry::Corners& corners) {
    const auto& [a, b, c] = corners;
    double distance = std::min(
        {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
    const geometry::Vec3 normal = glm::cross(b - a, c - a);
    const glm::dmat3 frame(b - a, c - a, normal);
    if (glm::determinant(frame) > 1e-18) {
        const geometry::Vec3 weights = glm::inverse(frame) * (p - a);
        if (weights.x >= 0.0 && weights.y >= 0.0 && weights.x + weights.y <= 1.0) {
            distance = std::min(distance, std::abs(weights.z) * glm::length(normal));
        }
    }
    return distance;
}

/// The one-sided distance of two surfaces by brute force.
struct SampledDistance {
    double largest = 0.0;  ///< of a sample
    double spacing = 0.0;  ///< no point of the surface is farther from a sample
};

/// Samples at the corners of steps x steps small triangles in each triangle of `from`.
inline SampledDistance sampled_distance(const geometry::Mesh& from,
                                        const geometry::Mesh& to,
                                        int steps) {
    SampledDistance result;
    for (std::size_t t = 0; t < from.triangles.size(); ++t) {
        const auto [a, b, c] = geometry::corners(from, t);
        result.spacing = std::max(
            result.spacing,
            std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)}) / steps);
        for (int i = 0; i <= steps; ++i) {
            for (int j = 0; i + j <= steps; ++j) {
                const geometry::Vec3 p = a + (b - a) * (static_cast<double>(i) / steps) +
                                         (c - a) * (static_cast<double>(j) / steps);
                double closest = std::numeric_limits<double>::infinity();
                for (std::size_t k = 0; k < to.triangles.size(); ++k) {
                    closest = std::min(closest, distance_to_triangle(p, geometry::corners(to, k)));
                }
                result.largest = std::max(result.largest, closest);
            }
        }
    }
    return result;
}

}  // namespace earshot::test
