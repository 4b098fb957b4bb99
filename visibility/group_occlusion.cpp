// SPDX-License-Identifier: MIT
#include "earshot/visibility/group_occlusion.h"

#include "earshot/base/assert.h"
#include "earshot/visibility/internal/point_groups.h"
#include "earshot/visibility/internal/viewer_front.h"

#include <cstddef>
#include <utility>

namespace earshot::visibility {

using geometry::MeshView;
using geometry::Vec3;

struct GroupOcclusion::State {
    State(const MeshView& mesh, const ExclusionMask& mask)
        : excluded(mask), occluders(mesh, excluded) {}

    ExclusionMask excluded;
    Occluders occluders;
    PointGroups groups;
    std::vector<ViewerFront> fronts;  // per viewer
    GroupFrame frame;
};

GroupOcclusion::GroupOcclusion(const MeshView& mesh, const ExclusionMask& excluded)
    : state_(std::make_unique<State>(mesh, excluded)) {}

GroupOcclusion::~GroupOcclusion() = default;
GroupOcclusion::GroupOcclusion(GroupOcclusion&&) noexcept = default;
GroupOcclusion& GroupOcclusion::operator=(GroupOcclusion&&) noexcept = default;

void GroupOcclusion::begin_frame(const bvh::MeshBvh& bvh,
                                 const Motion& motion,
                                 std::span<const Vec3> viewers,
                                 std::span<const Vec3> points,
                                 Executor& executor) {
    State& state = *state_;
    const bool is_same_topology = state.groups.update(points, executor);
    if (!is_same_topology || state.fronts.size() != viewers.size()) {
        state.fronts.assign(viewers.size(), ViewerFront(state.groups));
    }
    if (!motion.triangles.empty()) {
        state.occluders.remove_moved_patches(motion.triangles);
    }
    const std::uint32_t last_motion =
        motion.triangles.empty() ? state.frame.last_motion : state.frame.number + 1;
    state.frame = {.number = state.frame.number + 1,
                   .last_motion_before = state.frame.last_motion,
                   .last_motion = last_motion,
                   .bvh = &bvh,
                   .excluded = &state.excluded,
                   .occluders = &state.occluders,
                   .groups = &state.groups,
                   .moved = motion.triangles,
                   .moved_box = motion.box,
                   .viewers = viewers};
}

void GroupOcclusion::visible(std::size_t viewer,
                             std::span<std::uint8_t> visible,
                             Executor& executor) {
    EARSHOT_ASSERT(viewer < state_->fronts.size());
    EARSHOT_ASSERT(visible.size() == state_->groups.point_count());
    state_->fronts[viewer].decide(state_->frame, state_->frame.viewers[viewer], visible, executor);
}

GroupOcclusionStatistics GroupOcclusion::statistics() const {
    GroupOcclusionStatistics sum;
    for (const ViewerFront& front : state_->fronts) {
        if (front.frame() == state_->frame.number) {
            sum.decided += front.statistics().decided;
            sum.kept += front.statistics().kept;
            sum.rays += front.statistics().rays;
            sum.searches += front.statistics().searches;
            sum.shafts += front.statistics().shafts;
            sum.occluder_tests += front.statistics().occluder_tests;
        }
    }
    return sum;
}

}  // namespace earshot::visibility
