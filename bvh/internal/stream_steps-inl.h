// SPDX-License-Identifier: MIT
//
// Many rays on their way through a WideTree, several at a time: while the memory fetches what one
// needs next, the others go on. Included by kernels once per instruction set, after
// wide_steps-inl.h, float_ray-inl.h and decision_queue-inl.h.

#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#include <optional>
#include <span>

#if defined(EARSHOT_BVH_STREAM_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_STREAM_STEPS_INL_H
#undef EARSHOT_BVH_STREAM_STEPS_INL_H
#else
#define EARSHOT_BVH_STREAM_STEPS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

// So many rays are under way together: enough to hide a read from memory, and their stacks still
// fit into the first cache.
constexpr std::size_t kTogether = 6;

/// Fetches what will be visited next.
HWY_INLINE void prefetch(const WideTree& tree, std::uint32_t child) {
    const char* place = is_leaf(child) ? reinterpret_cast<const char*>(tree.leaf_words(child))
                                       : reinterpret_cast<const char*>(tree.nodes().data() + child);
    for (std::size_t line = 0; line < sizeof(WideNode); line += 64) {
        __builtin_prefetch(place + line);
    }
}

/// A search for a closest hit, step by step.
class ClosestLane {
public:
    /// False: the ray is out of range.
    HWY_INLINE bool start(const WideTree& tree,
                          const geometry::MeshView& mesh,
                          const geometry::Ray& ray,
                          double reach) {
        if (!set_ray(ray_, ray, static_cast<float>(reach))) {
            return false;
        }
        search.emplace(mesh, ray, reach);
        search->bound = ray_.t_max;
        walk_.count = 0;
        walk_.child = 0;
        prefetch(tree, 0);
        return true;
    }

    /// False: there is nothing more to visit.
    HWY_INLINE bool step(const WideTree& tree) {
        bool goes_on = false;
        if (is_leaf(walk_.child)) {
            LeafRoom room;
            visit_leaf(open_leaf(tree, walk_.child, room), ray_, *search, left_);
            goes_on = walk_.pop(search->bound);
        } else {
            goes_on = descend(tree.nodes()[walk_.child],
                              PassingFromPlane(ray_, left_plane_),
                              ray_.order_shift,
                              search->bound,
                              walk_);
        }
        if (goes_on) {
            prefetch(tree, walk_.child);
        }
        return goes_on;
    }

    /// The triangle that the ray leaves.
    HWY_INLINE void leave(const geometry::MeshView& mesh, std::uint32_t triangle) {
        left_ = triangle;
        left_plane_ = LeftPlane(mesh, triangle);
    }

    std::size_t index = 0;  ///< of the ray
    std::optional<ClosestSearch> search;

private:
    std::uint32_t left_ = kNoTriangle;
    LeftPlane left_plane_;
    FloatRay ray_;
    Walk walk_;
};

/// Searches for the closest hits of rays [begin, end), and leaves the last word to the queue.
HWY_INLINE void trace_stream(const WideTree& tree,
                             const geometry::MeshView& mesh,
                             const LeavingRays& leaving,
                             std::size_t begin,
                             std::size_t end,
                             std::span<std::optional<geometry::Hit>> hits,
                             DecisionQueue& queue) {
    const double reach = tree.reach();
    ClosestLane lanes[kTogether];
    std::size_t next = begin;
    const auto start = [&](ClosestLane& lane) {
        for (; next < end; ++next) {
            if (lane.start(tree, mesh, leaving.rays[next], reach)) {
                if (!leaving.left.empty()) {
                    lane.leave(mesh, leaving.left[next]);
                }
                lane.index = next++;
                return true;
            }
            hits[next] = closest_hit(tree, mesh, leaving.rays[next]);
        }
        return false;
    };
    std::size_t active = 0;
    while (active < kTogether && start(lanes[active])) {
        ++active;
    }
    while (active > 0) {
        for (std::size_t i = 0; i < active;) {
            if (lanes[i].step(tree)) {
                ++i;
                continue;
            }
            const std::size_t index = lanes[i].index;
            hits[index] = lanes[i].search->best();
            lanes[i].search->for_each_left(
                [&](std::uint32_t triangle) { queue.push(index, triangle); });
            if (start(lanes[i])) {
                ++i;
            } else if (--active != i) {
                lanes[i] = lanes[active];
            }
        }
    }
}

/// A search for any touch, step by step.
class AnyLane {
public:
    HWY_INLINE bool start(const WideTree& tree, const geometry::Segment& segment, double reach) {
        if (!set_ray(ray_, ray_along(segment), static_cast<float>(reach))) {
            return false;
        }
        segment_ = segment;
        walk_.count = 0;
        walk_.child = 0;
        is_blocked = false;
        prefetch(tree, 0);
        return true;
    }

    HWY_INLINE bool step(const WideTree& tree, const geometry::MeshView& mesh) {
        bool goes_on = false;
        if (is_leaf(walk_.child)) {
            LeafRoom room;
            is_blocked =
                touches_leaf(open_leaf(tree, walk_.child, room), ray_, mesh, segment_, left_);
            goes_on = !is_blocked && walk_.pop(ray_.t_max);
        } else {
            goes_on = descend(tree.nodes()[walk_.child],
                              PassingFromPlane(ray_, left_plane_),
                              ray_.order_shift,
                              ray_.t_max,
                              walk_);
        }
        if (goes_on) {
            prefetch(tree, walk_.child);
        }
        return goes_on;
    }

    /// The triangle that the segment leaves.
    HWY_INLINE void leave(const geometry::MeshView& mesh, std::uint32_t triangle) {
        left_ = triangle;
        left_plane_ = LeftPlane(mesh, triangle);
    }

    std::size_t index = 0;
    bool is_blocked = false;

private:
    std::uint32_t left_ = kNoTriangle;
    LeftPlane left_plane_;
    FloatRay ray_;
    geometry::Segment segment_;
    Walk walk_;
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
