// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/exclusion_mask.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The work of a frame.
struct GroupOcclusionStatistics {
    std::uint64_t decided = 0;         ///< pairs that a group decided
    std::uint64_t kept = 0;            ///< pairs that the last blocker of the single point decided
    std::uint64_t rays = 0;            ///< the other pairs
    std::uint64_t searches = 0;        ///< of the triangle that blocks a pair
    std::uint64_t shafts = 0;          ///< traversals of the mesh's hierarchy by a shaft
    std::uint64_t occluder_tests = 0;  ///< of an occluder and a box

    friend bool operator==(const GroupOcclusionStatistics&,
                           const GroupOcclusionStatistics&) = default;
};

/// Line of sight between a few viewers and thousands of points, frame by frame, decided for whole
/// groups where a proof allows it. The points are held in a hierarchy. A group of them is hidden
/// if one occluder hides its box, and visible if no triangle touches the hull of viewer and box;
/// other groups are divided, and single points tested with what blocked them last, or by a ray.
/// Proofs are made for a part of the way that the viewer is going to take, so that they hold
/// without a test until it leaves that or something moves that they depend on: what CHC++ assumes
/// of visible nodes for some frames (Mattausch et al. 2008) is known here. Which proofs are tried,
/// and for how many frames, follows from how long the last ones have held and from what they have
/// saved.
///
/// Answers are those of line_of_sight.h to the last bit; work and answers depend on no executor.
class GroupOcclusion {
public:
    /// Precondition: the mesh is not empty.
    GroupOcclusion(const geometry::MeshView& mesh, const ExclusionMask& excluded);
    ~GroupOcclusion();
    GroupOcclusion(GroupOcclusion&&) noexcept;
    GroupOcclusion& operator=(GroupOcclusion&&) noexcept;

    /// What has moved since the last frame.
    struct Motion {
        std::span<const std::uint8_t> triangles{};  ///< a flag each; empty if none has moved
        geometry::Aabb box{};  ///< of these triangles as they were and as they are
    };

    /// Begins a frame. Viewers and points are identified by their index; if there are as many as in
    /// the last frame each may have moved, else all is forgotten. Preconditions: the triangles of
    /// the constructor's mesh; coordinates are finite, at most 1e12 m; what `bvh` and the spans
    /// refer to outlives the frame.
    void begin_frame(const bvh::MeshBvh& bvh,
                     const Motion& motion,
                     std::span<const geometry::Vec3> viewers,
                     std::span<const geometry::Vec3> points,
                     Executor& executor = Executor::serial());

    /// Writes visible() of the viewer and every point, 1 or 0. Once per frame for each viewer;
    /// different viewers may be answered by different threads.
    void visible(std::size_t viewer,
                 std::span<std::uint8_t> visible,
                 Executor& executor = Executor::serial());

    /// Of the frame, over the viewers that have been decided.
    GroupOcclusionStatistics statistics() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::visibility
