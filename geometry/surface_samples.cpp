// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/surface_samples.h"

#include <glm/geometric.hpp>

#include <limits>

namespace earshot::geometry {

double squared_distance(const Vec3& point, const Corners& triangle) noexcept {
    // Ericson 2005, section 5.1.5: the feature of the triangle in whose Voronoi region the point
    // lies.
    const auto& [a, b, c] = triangle;
    const auto from = [&](const Vec3& closest) {
        const Vec3 rest = point - closest;
        return glm::dot(rest, rest);
    };
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 ap = point - a;
    const double d1 = glm::dot(ab, ap);
    const double d2 = glm::dot(ac, ap);
    if (d1 <= 0.0 && d2 <= 0.0) {
        return from(a);
    }
    const Vec3 bp = point - b;
    const double d3 = glm::dot(ab, bp);
    const double d4 = glm::dot(ac, bp);
    if (d3 >= 0.0 && d4 <= d3) {
        return from(b);
    }
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        return from(a + d1 / (d1 - d3) * ab);
    }
    const Vec3 cp = point - c;
    const double d5 = glm::dot(ab, cp);
    const double d6 = glm::dot(ac, cp);
    if (d6 >= 0.0 && d5 <= d6) {
        return from(c);
    }
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        return from(a + d2 / (d2 - d6) * ac);
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        return from(b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
    }
    const double sum = va + vb + vc;
    return from(a + vb / sum * ab + vc / sum * ac);
}

SurfaceSamples::SurfaceSamples(std::vector<std::uint32_t> labels)
    : labels_(std::move(labels)), first_(labels_.size(), kNone) {}

void SurfaceSamples::add(Element element, const Vec3& point) {
    next_.push_back(first_[element]);
    first_[element] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
}

bool SurfaceSamples::fits(std::span<const Element> removed,
                          std::span<const Made> made,
                          double max_distance,
                          Moves& moves) const {
    moves.clear();
    const double max_squared = max_distance * max_distance;
    for (const Element element : removed) {
        for (std::uint32_t i = first_[element]; i != kNone; i = next_[i]) {
            double best = std::numeric_limits<double>::infinity();
            Element closest = kNone;
            for (const Made& candidate : made) {
                if (labels_[candidate.element] != labels_[element]) {
                    continue;
                }
                const double squared = squared_distance(points_[i], candidate.corners);
                if (squared < best) {
                    best = squared;
                    closest = candidate.element;
                }
            }
            if (!(best <= max_squared)) {
                return false;
            }
            moves.emplace_back(i, closest);
        }
    }
    return true;
}

void SurfaceSamples::move(std::span<const Element> removed, const Moves& moves) {
    for (const Element element : removed) {
        first_[element] = kNone;
    }
    for (const auto& [point, element] : moves) {
        next_[point] = first_[element];
        first_[element] = point;
    }
}

}  // namespace earshot::geometry
