// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/edge_paths.h"
#include "earshot/frustum/internal/beam_tree.h"
#include "earshot/frustum/internal/edge_intervals.h"
#include "earshot/frustum/internal/image_tree.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace earshot::frustum {

/// A wedge that sound from one point may reach over a sequence of facets.
struct EdgeCandidate {
    EdgeEnd end;
    std::uint32_t image = 0;  ///< index into the point's image tree
    /// Where EdgeSides keeps what is decided, counted from 1; 0: nothing is yet.
    std::uint32_t window = 0, parts = 0;
};

/// What sound from one point, a source or a listener, reaches of the edges of a scene: candidates
/// by wedge, whose parts are decided when they are asked for. Each is decided once.
class EdgeSides {
public:
    /// A wedge and an image by which it may be reached, in any order and number.
    using Pair = std::pair<std::uint32_t, std::uint32_t>;

    /// Keeps the pairs in which the edge is seen from within the wedge's air. Scene, wedges and
    /// verifier must outlive it.
    EdgeSides(const SceneView& scene,
              const PathVerifier& verifier,
              std::span<const geometry::Wedge> wedges,
              ImageTree images,
              std::span<const std::vector<Pair>> pairs,
              Executor& executor);

    const geometry::Vec3& point() const noexcept { return images_[0].position; }
    const ImageTree& images() const noexcept { return images_; }
    /// The candidates of a wedge, by the order of their images.
    std::span<const EdgeCandidate> of(std::size_t wedge) const noexcept {
        return std::span(candidates_).subspan(first_[wedge], first_[wedge + 1] - first_[wedge]);
    }
    std::size_t size() const noexcept { return candidates_.size(); }
    std::size_t bytes() const noexcept;  ///< of memory, about

    /// The part of the wedge to which the facets of its i-th candidate reflect, without regard to
    /// what lies between; empty if they do not. To be called as parts().
    geometry::Interval window(std::size_t wedge, std::size_t i);

    /// The parts of the wedge that its i-th candidate reaches: disjoint, ascending, and none for
    /// most candidates. Layers of one surface reflect once: of sequences with one image, the first
    /// has what both reach. Valid until the next call for the wedge; to be called by one thread per
    /// wedge at a time.
    std::span<const geometry::Interval> parts(std::size_t wedge, std::size_t i);

private:
    void decide(std::size_t wedge, std::size_t i);

    SceneView scene_;
    EdgeIntervals intervals_;
    std::span<const geometry::Wedge> wedges_;
    ImageTree images_;
    std::vector<std::size_t> first_;         // per wedge, and one past the last
    std::vector<EdgeCandidate> candidates_;  // by wedge, then by image
    std::vector<std::vector<std::vector<geometry::Interval>>> parts_of_wedge_;
    std::vector<std::vector<geometry::Interval>> windows_of_wedge_;
};

/// Finds the candidates of points by beam trees.
class EdgeTracer {
public:
    /// Everything must outlive it.
    EdgeTracer(const SceneView& scene,
               const FacetIndex& index,
               const PathVerifier& verifier,
               std::span<const geometry::Wedge> wedges,
               const TraceOptions& trace);

    EdgeSides trace(const geometry::Vec3& point,
                    EdgeStatistics& statistics,
                    Executor& executor) const;

private:
    SceneView scene_;
    const FacetIndex& index_;
    const PathVerifier& verifier_;
    std::span<const geometry::Wedge> wedges_;
    TraceOptions trace_;
    std::vector<std::vector<std::uint32_t>> wedges_of_facet_;
};

/// Every wedge with every sequence of up to `max_reflections` facets.
EdgeSides all_edge_sides(const SceneView& scene,
                         const PathVerifier& verifier,
                         std::span<const geometry::Wedge> wedges,
                         const geometry::Vec3& point,
                         int max_reflections);

}  // namespace earshot::frustum
