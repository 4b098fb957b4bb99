// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/group_occlusion.h"
#include "earshot/visibility/internal/occluders.h"
#include "earshot/visibility/internal/point_groups.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// What the viewers of a frame have in common.
struct GroupFrame {
    std::uint32_t number = 0;
    /// The last frame in which a triangle had moved, before this one and with this one; 0: none.
    std::uint32_t last_motion_before = 0, last_motion = 0;
    const bvh::MeshBvh* bvh = nullptr;
    const ExclusionMask* excluded = nullptr;
    const Occluders* occluders = nullptr;
    const PointGroups* groups = nullptr;
    std::span<const std::uint8_t> moved{};
    geometry::Aabb moved_box{};
    std::span<const geometry::Vec3> viewers{};
};

/// The proofs that one viewer has for the groups of a hierarchy of points, from frame to frame.
/// They are made for a unit of PointGroups at a time: the triangles in its shaft are listed once,
/// and parts of it are tested with those of the list alone.
class ViewerFront {
public:
    explicit ViewerFront(const PointGroups& groups);

    /// See GroupOcclusion::visible().
    void decide(const GroupFrame& frame,
                const geometry::Vec3& position,
                std::span<std::uint8_t> visible,
                Executor& executor);

    std::uint32_t frame() const noexcept { return frame_; }
    /// Of the last frame.
    const GroupOcclusionStatistics& statistics() const noexcept { return statistics_; }

private:
    using Id = Occluders::Id;
    static constexpr std::size_t kMaxRemembered = 2;

    struct Unit {
        ViewerRegion region{};        // for which the proofs hold
        bool is_proved = false;       // whether there are any
        std::uint8_t failures = 0;    // in a row
        std::uint8_t horizon = 3;     // proofs are for about 2^horizon frames
        std::uint32_t made = 0;       // the frame
        std::uint32_t version = 0;    // of the node, for which they hold
        std::uint32_t checked = 0;    // the last frame in which they did
        std::uint32_t next_test = 0;  // no proofs are tried before this frame
        std::uint32_t occluder_count = 0;
        std::array<Id, kMaxRemembered> occluders{};  // the last to hide a part of it first
    };

    enum class Verdict : std::uint8_t { hidden, visible, undecided };
    class Renewal;

    void begin_frame(const GroupFrame& frame, const geometry::Vec3& position);
    /// A viewer that turns in every frame has no way ahead.
    bool can_prove() const noexcept {
        return knows_step_ && frames_since_turn_ + frames_before_turn_ > 0 && budget_ > 0.0;
    }
    bool holds(const GroupFrame& frame, std::uint32_t node, Unit& unit) const;
    ViewerRegion region_ahead(std::uint32_t node, unsigned horizon) const;
    void renew(const GroupFrame& frame, std::uint32_t node, Unit& unit);
    void schedule(const GroupFrame& frame,
                  std::uint32_t node,
                  Unit& unit,
                  const Renewal& renewal) const;
    bool is_hidden_by_last(const GroupFrame& frame, std::uint32_t place);
    void cast_rays(const GroupFrame& frame, std::span<std::uint8_t> visible, Executor& executor);
    void find_blockers(const GroupFrame& frame, Executor& executor);

    std::uint32_t frame_ = 0;
    geometry::Vec3 position_{0.0}, step_{0.0};
    bool knows_step_ = false;
    std::uint32_t frames_since_turn_ = 0;   // of the viewer
    std::uint32_t frames_before_turn_ = 0;  // between that and the one before
    std::vector<Unit> units_;
    double budget_ = 0.0;  // what proofs may still cost, in rays
    double tested_blockers_ = 0.0, kept_blockers_ = 0.0;
    std::uint64_t blocker_tests_ = 0;  // of the frame
    GroupOcclusionStatistics statistics_;

    // Per point, in the order of PointGroups.
    std::vector<Verdict> verdicts_;
    std::vector<geometry::TriangleId> blockers_;  // the last triangle in its way, if it is known
    std::vector<std::uint8_t> was_visible_;       // in the last frame

    // While rays of a frame are cast.
    std::vector<std::uint32_t> undecided_, blocked_;
    std::vector<geometry::Segment> segments_;
    std::vector<std::uint8_t> answers_;
    std::vector<geometry::Ray> rays_;
    std::vector<std::optional<geometry::Hit>> hits_;
};

}  // namespace earshot::visibility
