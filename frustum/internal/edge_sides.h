// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/edge_intervals.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::frustum {

/// A wedge that sound from one point may reach over a sequence of facets.
struct EdgeCandidate {
    std::uint32_t wedge = 0;
    std::vector<geometry::FacetId> sequence;  ///< the point's end first
};

/// What sound from one point, a source or a listener, reaches of an edge.
struct EdgeSide {
    std::uint32_t wedge = 0;
    std::vector<geometry::FacetId> sequence;  ///< the point's end first
    geometry::Vec3 image{0.0};                ///< the point mirrored in the sequence
    std::vector<geometry::Interval> parts;    ///< not empty
};

/// The candidates in order of wedge, length of the sequence and facets, each once.
void sort_and_deduplicate(std::vector<EdgeCandidate>& candidates);

/// The candidates of which some part is reached, in their order.
std::vector<EdgeSide> find_sides(const SceneView& scene,
                                 const PathVerifier& verifier,
                                 std::span<const geometry::Wedge> wedges,
                                 const geometry::Vec3& point,
                                 std::vector<EdgeCandidate> candidates,
                                 Executor& executor);

}  // namespace earshot::frustum
