// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"
#include "earshot/geometry/internal/first_index_table.h"
#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::geometry {

/// An edge of a facet's outline; the facet lies to its left seen against the normal.
struct BorderEdge {
    Vec3 from{0.0}, to{0.0};
    FacetId facet = 0;
};

/// Outline edges with the same two ends are one segment.
struct BorderSegment {
    std::array<std::uint32_t, 2> ends{};  ///< points; the smaller (by x, then y, then z) first
    double squared_length = 0.0;
    Vec3 direction{0.0};  ///< unit vector from the first end to the second
};

/// The outline edges of facets, and which of them lie on one straight line and touch or overlap.
struct BorderSegments {
    static constexpr std::uint32_t kNone = FirstIndexTable::kNone;
    using Contact = std::array<std::uint32_t, 2>;

    double tolerance = -1.0;
    std::vector<BorderEdge> edges;              ///< by facet and along its loops
    std::vector<std::uint32_t> first_of_facet;  ///< per facet, and one past the last: of edges
    std::vector<std::uint32_t> segment_of_edge;
    std::vector<BorderSegment> segments;
    std::vector<Vec3> points;  ///< their ends, all different
    FirstIndexTable point_table{0};
    std::vector<std::uint32_t> first_at_point;     ///< per point, of segments_at_point
    std::vector<std::uint32_t> segments_at_point;  ///< ascending

    /// Pairs of segments in any order, each once. Those up to `known_contacts` were known before.
    std::vector<Contact> contacts;
    std::size_t known_contacts = 0;
    std::vector<std::uint32_t> before;  ///< per segment: its number before, or kNone

    std::span<const BorderEdge> edges_of(FacetId facet) const noexcept {
        return std::span(edges).subspan(first_of_facet[facet],
                                        first_of_facet[facet + 1] - first_of_facet[facet]);
    }
    std::span<const std::uint32_t> at_point(std::uint32_t point) const noexcept {
        return std::span(segments_at_point)
            .subspan(first_at_point[point], first_at_point[point + 1] - first_at_point[point]);
    }
};

/// The segments of the facets, without those with `excluded` 1 (none if it is empty). Two are in
/// contact if the shorter lies on the line of the longer and reaches it, within `tolerance`,
/// metres. That depends on the two alone, so contacts between segments that were there `before`, at
/// the same tolerance, need not be found again.
BorderSegments find_border_segments(const Facets& facets,
                                    std::span<const std::uint8_t> excluded,
                                    double tolerance,
                                    const BorderSegments& before = {});

}  // namespace earshot::geometry
