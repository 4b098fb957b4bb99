// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/moving_tree.h"
#include "earshot/visibility/line_of_sight.h"
#include "earshot/visibility/sight_matrix.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The work that an answer took.
struct SightCounts {
    std::uint64_t nodes = 0;      ///< of the tree that were looked into
    std::uint64_t triangles = 0;  ///< that were tested exactly
    std::uint64_t kept = 0;       ///< pairs whose last answer held without a look into the tree

    friend bool operator==(const SightCounts&, const SightCounts&) = default;
};

/// Line of sight between the same pairs of points time after time, while the mesh deforms. What was
/// found the last time is tried first: a pair that was blocked is tested against the triangle that
/// blocked it, and one that was not only against triangles that have moved since. The answers are
/// those of line_of_sight.h to the last bit; only the work differs.
class CoherentSight {
public:
    /// Builds the tree; throws as bvh::MovingTree does.
    CoherentSight(const geometry::MeshView& mesh,
                  Ignored ignored = {},
                  const bvh::UpdateOptions& options = {},
                  Executor& executor = Executor::serial());

    /// sees() of every segment, 1 or 0, where the mesh is now; valid until the next call. Segment i
    /// is taken for segment i of the call before, whose ends may have moved too; if the number of
    /// segments is another, nothing is remembered. Precondition: the triangles of the first mesh.
    const std::vector<std::uint8_t>& sees(const geometry::MeshView& mesh,
                                          std::span<const geometry::Segment> segments,
                                          Executor& executor = Executor::serial());

    /// The same for every pair of two sets of points, row-major from x to.
    const std::vector<std::uint8_t>& matrix(const geometry::MeshView& mesh,
                                            const SightPoints& points,
                                            Executor& executor = Executor::serial());

    /// Whether what is done is counted from now on. It is then done node by node, which takes
    /// longer; the answers are the same.
    void count_work(bool is_counted) noexcept { is_counted_ = is_counted; }

    /// Of the last call if it was counted, else of no meaning; the same for any executor.
    const SightCounts& counts() const noexcept { return counts_; }

private:
    /// Follows the mesh and marks what has moved since the last call.
    void follow(const geometry::MeshView& mesh, Executor& executor);
    void mark_slots();
    bool may_meet_moved(const geometry::Segment& segment) const noexcept;
    /// Forgets the pairs of the last call if there are not as many now.
    void expect_pairs(std::size_t count);

    /// Answers all pairs: segment_of(i) is pair i, and has_moved(i) says whether an end has.
    template <typename SegmentOf, typename HasMoved>
    void answer(const geometry::MeshView& mesh,
                const SegmentOf& segment_of,
                const HasMoved& has_moved,
                Executor& executor);

    /// What blocks a pair, or kNoBlocker; `last`: the same at the last call.
    geometry::TriangleId state_of(const geometry::MeshView& mesh,
                                  const geometry::Segment& segment,
                                  geometry::TriangleId last,
                                  bool has_moved,
                                  SightCounts& counts) const noexcept;

    Ignored ignored_;
    bvh::MovingTree tree_;
    std::vector<geometry::Vec3> positions_;     // of the mesh at the last call
    std::vector<std::uint8_t> moved_;           // per triangle
    geometry::Aabb moved_box_;                  // of the triangles that have moved
    std::vector<std::uint8_t> moved_slots_;     // per node, a bit per slot with a moved triangle
    std::vector<geometry::TriangleId> states_;  // per pair
    std::vector<std::uint8_t> seen_;            // per pair
    std::vector<geometry::Segment> segments_;   // of the last call of sees()
    std::vector<geometry::Vec3> from_, to_;     // of the last call of matrix()
    bool is_counted_ = false;
    SightCounts counts_;
};

}  // namespace earshot::visibility
