// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/border_lines.h"

#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace earshot::geometry {
namespace {

double squared_length(const BorderEdge& edge) noexcept {
    return glm::dot(edge.to - edge.from, edge.to - edge.from);
}

/// The line of an edge, the same whichever way the edge runs.
BorderLine line_of(const BorderEdge& edge) {
    const bool is_forward = lexicographic_less(edge.from, edge.to);
    const Vec3& from = is_forward ? edge.from : edge.to;
    const Vec3& to = is_forward ? edge.to : edge.from;
    return {from, normalized(to - from), {}};
}

double distance_to_line(const BorderLine& line, const Vec3& point) noexcept {
    const Vec3 offset = point - line.origin;
    const Vec3 across = offset - glm::dot(offset, line.direction) * line.direction;
    return std::sqrt(glm::dot(across, across));
}

bool lies_on(const BorderEdge& edge, const BorderLine& line, double tolerance) noexcept {
    return distance_to_line(line, edge.from) <= tolerance &&
           distance_to_line(line, edge.to) <= tolerance;
}

/// Whether the first edge is the one that a line takes its direction from.
bool is_longer(const BorderEdge& a, const BorderEdge& b) noexcept {
    const double length_a = squared_length(a);
    const double length_b = squared_length(b);
    if (length_a != length_b) {
        return length_a > length_b;
    }
    const auto key = [](const BorderEdge& edge) {
        return std::minmax(edge.from, edge.to, lexicographic_less);
    };
    const auto [low_a, high_a] = key(a);
    const auto [low_b, high_b] = key(b);
    return low_a != low_b ? lexicographic_less(low_a, low_b) : lexicographic_less(high_a, high_b);
}

}  // namespace

double BorderLine::z_of(const Vec3& point) const noexcept {
    return glm::dot(point - origin, direction);
}

Box BorderLine::box(double margin) const noexcept {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const BorderEdge& edge : edges) {
        for (const Vec3& end : {edge.from, edge.to}) {
            low = std::min(low, z_of(end));
            high = std::max(high, z_of(end));
        }
    }
    const Vec3 a = point_at(low);
    const Vec3 b = point_at(high);
    return {glm::min(a, b) - margin, glm::max(a, b) + margin};
}

void split_into_lines(std::vector<BorderEdge> edges,
                      double tolerance,
                      std::vector<BorderLine>& lines) {
    while (!edges.empty()) {
        BorderLine line = line_of(*std::min_element(edges.begin(), edges.end(), is_longer));
        std::vector<BorderEdge> others;
        for (const BorderEdge& edge : edges) {
            (lies_on(edge, line, tolerance) ? line.edges : others).push_back(edge);
        }
        edges = std::move(others);
        lines.push_back(std::move(line));
    }
}

}  // namespace earshot::geometry
