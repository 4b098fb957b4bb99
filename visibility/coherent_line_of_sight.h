// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/visibility/group_occlusion.h"
#include "earshot/visibility/line_of_sight.h"
#include "earshot/visibility/visibility_matrix.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The work of a call of CoherentLineOfSight.
struct LineOfSightStatistics {
    std::uint64_t nodes = 0;      ///< nodes of the tree that were visited
    std::uint64_t triangles = 0;  ///< exact tests of a triangle
    std::uint64_t kept = 0;       ///< pairs whose last answer held without traversing the tree

    friend bool operator==(const LineOfSightStatistics&, const LineOfSightStatistics&) = default;
};

/// Point-to-point visibility of the same pairs in every frame of a mesh that deforms, with temporal
/// coherence: a pair that was blocked in the last frame is first tested against the triangle that
/// blocked it, and a pair that was visible only if triangles have moved since that may block it;
/// the rest are asked in batches. Blockers are tested and looked for where enough of the last ones
/// have held. Matrices with many points on one side are decided in groups (group_occlusion.h). The
/// answers are those of line_of_sight.h to the last bit; only the work differs.
class CoherentLineOfSight {
public:
    /// Builds the tree; throws as bvh::DeformableBvh does.
    CoherentLineOfSight(const geometry::MeshView& mesh,
                        ExclusionMask excluded = {},
                        const bvh::UpdateOptions& options = {},
                        Executor& executor = Executor::serial());

    /// visible() of every segment, 1 or 0, in the current pose of the mesh; valid until the next
    /// call. Segment i is identified with segment i of the call before, whose ends may have moved
    /// too; if the number of segments differs, all answers of the call before are forgotten.
    /// Precondition: the triangles of the first mesh.
    const std::vector<std::uint8_t>& visible(const geometry::MeshView& mesh,
                                             std::span<const geometry::Segment> segments,
                                             Executor& executor = Executor::serial());

    /// visible() of every pair of two sets of points, row-major from x to.
    const std::vector<std::uint8_t>& matrix(const geometry::MeshView& mesh,
                                            const PointSets& points,
                                            Executor& executor = Executor::serial());

    /// Collect statistics from now on. Pairs are then traversed one by one and node by node, which
    /// takes longer; the answers are the same.
    void collect_statistics(bool collect) noexcept { collects_statistics_ = collect; }

    /// How the hierarchy has followed the mesh.
    const bvh::UpdateStatistics& update_statistics() const noexcept {
        return tree_.update_statistics();
    }

    /// The work of the last call, if statistics are collected; the same for any executor.
    const LineOfSightStatistics& statistics() const noexcept { return statistics_; }

private:
    /// One pair of so many has its blocker tested and looked for, whether that pays or not.
    static constexpr std::size_t kSampleStep = 16;

    /// Updates the tree to the mesh and marks the triangles that have moved since the last call.
    void update(const geometry::MeshView& mesh, Executor& executor);
    void mark_slots();
    bool may_intersect_moved(const geometry::Segment& segment) const noexcept;
    /// Forgets the pairs of the last call if there are not as many now.
    void expect_pairs(std::size_t count);

    /// Answers all pairs: segment_of(i) is the segment of pair i, and has_moved(i) tells whether
    /// one of its ends has moved.
    template <typename SegmentOf, typename HasMoved>
    void answer(const geometry::MeshView& mesh,
                const SegmentOf& segment_of,
                const HasMoved& has_moved,
                Executor& executor);
    /// The same of the pairs [begin, end), for statistics.
    template <typename SegmentOf, typename HasMoved>
    void answer_one_by_one(const geometry::MeshView& mesh,
                           const SegmentOf& segment_of,
                           const HasMoved& has_moved,
                           Executor& executor);
    /// The same of a matrix, whose points on one side are many.
    void answer_in_groups(const geometry::MeshView& mesh,
                          const PointSets& points,
                          Executor& executor);

    /// How pairs fared whose blocker was known.
    struct Persistence {
        std::uint64_t known = 0, tested = 0, kept = 0, kept_when_tested = 0;
    };
    struct Chunk;

    template <typename SegmentOf, typename HasMoved>
    void answer_chunk(const geometry::MeshView& mesh,
                      const SegmentOf& segment_of,
                      const HasMoved& has_moved,
                      Chunk& chunk);
    void query_rest(const geometry::MeshView& mesh, Chunk& chunk);
    bool is_sample(std::size_t pair) const noexcept { return (pair + call_) % kSampleStep == 0; }

    /// The triangle that blocks a pair, or kNoBlocker; `last`: the one of the last call.
    geometry::TriangleId state_of(const geometry::MeshView& mesh,
                                  const geometry::Segment& segment,
                                  geometry::TriangleId last,
                                  bool has_moved,
                                  LineOfSightStatistics& statistics) const noexcept;

    ExclusionMask excluded_;
    bvh::DeformableBvh tree_;
    std::vector<geometry::Vec3> positions_;     // of the mesh at the last call
    std::vector<std::uint8_t> moved_;           // per triangle
    bool has_motion_ = false;                   // whether any has
    geometry::Aabb moved_box_;                  // of the triangles that have moved
    geometry::Aabb swept_box_;                  // the same with where they were
    std::vector<std::uint8_t> moved_slots_;     // per node, a bit per slot with a moved triangle
    std::vector<geometry::TriangleId> states_;  // per pair
    std::vector<std::uint8_t> visible_;         // per pair
    std::vector<geometry::Segment> segments_;   // of the last call of visible()
    std::vector<geometry::Vec3> from_, to_;     // of the last call of matrix()
    std::optional<GroupOcclusion> groups_;      // of the last call of matrix()
    std::vector<std::uint8_t> row_;             // of groups
    std::uint64_t call_ = 0;
    bool tests_blockers_ = false, searches_blockers_ = false;
    bool collects_statistics_ = false;
    LineOfSightStatistics statistics_;
};

}  // namespace earshot::visibility
