// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <span>

namespace earshot::frustum {

// Convex hulls of few points, told apart by the separating axis theorem. Hulls that overlap by no
// more than `slack` metres along some axis only touch, and count as separate.

template <typename Vector>
bool is_separating(const Vector& axis,
                   std::span<const Vector> a,
                   std::span<const Vector> b,
                   double slack) noexcept {
    const double length = glm::length(axis);
    if (!(length > 0.0)) {
        return false;
    }
    const auto range = [&](std::span<const Vector> points) {
        double low = glm::dot(axis, points.front()), high = low;
        for (const Vector& point : points) {
            const double at = glm::dot(axis, point);
            low = std::min(low, at);
            high = std::max(high, at);
        }
        return glm::dvec2(low, high);
    };
    const glm::dvec2 of_a = range(a);
    const glm::dvec2 of_b = range(b);
    // How far one would have to move along the axis to leave the other.
    const double depth = std::min(of_a.y - of_b.x, of_b.y - of_a.x);
    // Flat hulls in one plane are not told apart by its normal.
    const double wider = std::max(of_a.y - of_a.x, of_b.y - of_b.x);
    return depth <= slack * length && wider > slack * length;
}

/// In a plane.
inline bool are_separate(std::span<const glm::dvec2> a,
                         std::span<const glm::dvec2> b,
                         double slack) noexcept {
    for (const auto points : {a, b}) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t k = i + 1; k < points.size(); ++k) {
                const glm::dvec2 side = points[k] - points[i];
                if (is_separating(glm::dvec2(-side.y, side.x), a, b, slack)) {
                    return true;
                }
                // Of two points their own direction, which tells collinear ones apart.
                if (points.size() == 2 && is_separating(side, a, b, slack)) {
                    return true;
                }
            }
        }
    }
    return false;
}

/// In space. Precondition: neither hull is a segment or a point.
inline bool are_separate(std::span<const geometry::Vec3> a,
                         std::span<const geometry::Vec3> b,
                         double slack) noexcept {
    for (const auto points : {a, b}) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t k = i + 1; k < points.size(); ++k) {
                for (std::size_t l = k + 1; l < points.size(); ++l) {
                    const geometry::Vec3 normal =
                        glm::cross(points[k] - points[i], points[l] - points[i]);
                    if (is_separating(normal, a, b, slack)) {
                        return true;
                    }
                }
            }
        }
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t k = i + 1; k < a.size(); ++k) {
            for (std::size_t m = 0; m < b.size(); ++m) {
                for (std::size_t n = m + 1; n < b.size(); ++n) {
                    if (is_separating(glm::cross(a[k] - a[i], b[n] - b[m]), a, b, slack)) {
                        return true;
                    }
                }
            }
        }
    }
    return false;
}

}  // namespace earshot::frustum
