// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/edge_pair_paths.h"
#include "earshot/frustum/internal/edge_intervals.h"
#include "earshot/frustum/path_verifier.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

#include <vector>

namespace earshot::frustum {

/// A part of an edge.
struct EdgePart {
    const geometry::Wedge& wedge;
    geometry::Interval part{};
};

/// From which points of an edge which points of another are visible.
class EdgeLinks {
public:
    EdgeLinks(const SceneView& scene, const PathVerifier& verifier)
        : scene_(scene), verifier_(verifier), intervals_(scene, verifier) {}

    struct Found {
        std::vector<EdgeLink> links{};
        bool is_sampled = false;
    };

    /// Ways that leave and reach both wedges in the air between their faces.
    Found through_air(const EdgePart& first, const EdgePart& second) const;

    /// Ways along a face that both wedges border on. Preconditions: the faces are one side of one
    /// facet, and the edges do not lie on one line.
    Found along_face(const EdgePart& first,
                     const EdgePart& second,
                     const geometry::WedgeFace& face) const;

private:
    std::vector<geometry::Interval> in_air(const geometry::Wedge& about,
                                           const EdgePart& part) const;
    bool hull_is_free(const EdgePart& first, const EdgePart& second) const;
    void sample_air(const EdgePart& first, const EdgePart& second, Found& found) const;

    SceneView scene_;
    const PathVerifier& verifier_;
    EdgeIntervals intervals_;
};

}  // namespace earshot::frustum
