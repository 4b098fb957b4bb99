// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/border_lines.h"

#include "earshot/geometry/disjoint_sets.h"
#include "earshot/geometry/internal/point_tree.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::geometry {
namespace {

double squared_length(const BorderEdge& edge) noexcept {
    return glm::dot(edge.to - edge.from, edge.to - edge.from);
}

std::vector<BorderEdge> border_edges(const Facets& facets, std::span<const std::uint8_t> excluded) {
    std::vector<BorderEdge> edges;
    for (std::size_t i = 0; i < facets.facets.size(); ++i) {
        if (!excluded.empty() && excluded[i] != 0) {
            continue;
        }
        for (const Loop& loop : facets.facets[i].loops) {
            for (std::size_t k = 0; k < loop.size(); ++k) {
                edges.push_back({loop[k], loop[(k + 1) % loop.size()], static_cast<FacetId>(i)});
            }
        }
    }
    return edges;
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

/// Edges that touch are on one line if the shorter lies on the line of the longer. Chains of such
/// pairs may bend slowly: what is off the line of the longest edge becomes a line of its own.
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

}  // namespace

std::vector<BorderLine> find_border_lines(const Facets& facets,
                                          std::span<const std::uint8_t> excluded,
                                          double tolerance) {
    const std::vector<BorderEdge> edges = border_edges(facets, excluded);
    std::vector<PointTree::Point> ends;
    ends.reserve(2 * edges.size());
    for (std::size_t i = 0; i < edges.size(); ++i) {
        ends.push_back({edges[i].from, static_cast<VertexId>(i)});
        ends.push_back({edges[i].to, static_cast<VertexId>(i)});
    }
    const PointTree tree(std::move(ends));

    // Of two edges that touch or overlap on a line, an end of one lies on the other.
    DisjointSets sets(edges.size());
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
        const BorderLine line = line_of(edges[i]);
        tree.near_segment(
            {edges[i].from, edges[i].to}, tolerance, [&](const PointTree::Point& point) {
                const BorderEdge& other = edges[point.vertex];
                if (point.vertex != i &&
                    (is_longer(other, edges[i]) ? lies_on(edges[i], line_of(other), tolerance)
                                                : lies_on(other, line, tolerance))) {
                    sets.unite(i, point.vertex);
                }
            });
    }
    std::vector<std::vector<BorderEdge>> groups(edges.size());
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
        groups[sets.find(i)].push_back(edges[i]);
    }
    std::vector<BorderLine> lines;
    for (std::vector<BorderEdge>& group : groups) {
        split_into_lines(std::move(group), tolerance, lines);
    }
    std::sort(lines.begin(), lines.end(), [](const BorderLine& a, const BorderLine& b) {
        const FacetId first = a.edges.front().facet;
        const FacetId second = b.edges.front().facet;
        return first != second        ? first < second
               : a.origin != b.origin ? lexicographic_less(a.origin, b.origin)
                                      : lexicographic_less(a.direction, b.direction);
    });
    return lines;
}

}  // namespace earshot::geometry
