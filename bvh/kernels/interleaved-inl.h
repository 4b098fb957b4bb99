// SPDX-License-Identifier: MIT
//
// Interleaved traversal of a WideTree, compiled once per instruction set: several rays are in
// flight at a time (Kocberber, Falsafi and Grot 2015), so that while the memory fetches what one
// needs next, the others advance (latency hiding).

#include "earshot/bvh/internal/closest_hit_search.h"
#include "earshot/bvh/kernels/exact_queue-inl.h"
#include "earshot/bvh/kernels/float_ray-inl.h"
#include "earshot/bvh/kernels/leaf-inl.h"
#include "earshot/bvh/kernels/node-inl.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#if defined(EARSHOT_BVH_KERNELS_INTERLEAVED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_INTERLEAVED_INL_H
#undef EARSHOT_BVH_KERNELS_INTERLEAVED_INL_H
#else
#define EARSHOT_BVH_KERNELS_INTERLEAVED_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

// So many rays are in flight: enough to hide a read from memory, and their stacks still fit into
// the first cache.
constexpr std::size_t kRaysInFlight = 6;

/// Fetches what will be visited next.
HWY_INLINE void prefetch(const WideTree& tree, std::uint32_t child) {
    const char* address = is_leaf(child)
                              ? reinterpret_cast<const char*>(tree.packed_leaf(child))
                              : reinterpret_cast<const char*>(tree.nodes().data() + child);
    for (std::size_t line = 0; line < sizeof(WideNode); line += 64) {
        __builtin_prefetch(address + line);
    }
}

/// The search of one ray in flight for its closest hit, step by step.
class ClosestInFlight {
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
        stack_.count = 0;
        stack_.current = 0;
        prefetch(tree, 0);
        return true;
    }

    /// False: there is nothing more to visit.
    HWY_INLINE bool step(const WideTree& tree) {
        bool has_next = false;
        if (is_leaf(stack_.current)) {
            DecodeBuffer buffer;
            visit_leaf(decode_leaf(tree, stack_.current, buffer), ray_, *search, excluded_);
            has_next = stack_.pop(search->bound);
        } else {
            has_next = descend(tree.nodes()[stack_.current],
                               SlabTestSkippingCoplanar(ray_, excluded_plane_),
                               ray_.order_shift,
                               search->bound,
                               stack_);
        }
        if (has_next) {
            prefetch(tree, stack_.current);
        }
        return has_next;
    }

    /// Excludes the triangle that the ray starts from.
    HWY_INLINE void exclude(const geometry::MeshView& mesh, std::uint32_t triangle) {
        excluded_ = triangle;
        excluded_plane_ = ExcludedPlane(mesh, triangle);
    }

    std::size_t index = 0;  ///< of the ray
    std::optional<ClosestHitSearch> search;

private:
    std::uint32_t excluded_ = kNoTriangle;
    ExcludedPlane excluded_plane_;
    FloatRay ray_;
    TraversalStack stack_;
};

/// Searches for the closest hits of rays [begin, end); the queue decides the last candidates.
HWY_INLINE void closest_interleaved(const WideTree& tree,
                                    const geometry::MeshView& mesh,
                                    const SecondaryRays& secondary_rays,
                                    std::size_t begin,
                                    std::size_t end,
                                    std::span<std::optional<geometry::Hit>> hits,
                                    ExactTestQueue& queue) {
    const double reach = tree.max_abs_coordinate();
    ClosestInFlight in_flight[kRaysInFlight];
    std::size_t next = begin;
    const auto start = [&](ClosestInFlight& slot) {
        for (; next < end; ++next) {
            if (slot.start(tree, mesh, secondary_rays.rays[next], reach)) {
                if (!secondary_rays.origin_triangles.empty()) {
                    slot.exclude(mesh, secondary_rays.origin_triangles[next]);
                }
                slot.index = next++;
                return true;
            }
            hits[next] = closest_hit(tree, mesh, secondary_rays.rays[next]);
        }
        return false;
    };
    std::size_t active = 0;
    while (active < kRaysInFlight && start(in_flight[active])) {
        ++active;
    }
    while (active > 0) {
        for (std::size_t i = 0; i < active;) {
            if (in_flight[i].step(tree)) {
                ++i;
                continue;
            }
            const std::size_t index = in_flight[i].index;
            hits[index] = in_flight[i].search->best();
            in_flight[i].search->for_each_pending(
                [&](std::uint32_t triangle) { queue.push(index, triangle); });
            if (start(in_flight[i])) {
                ++i;
            } else if (--active != i) {
                in_flight[i] = in_flight[active];
            }
        }
    }
}

/// The search of one segment in flight for any touch, step by step.
class AnyInFlight {
public:
    HWY_INLINE bool start(const WideTree& tree, const geometry::Segment& segment, double reach) {
        if (!set_ray(ray_, ray_along(segment), static_cast<float>(reach))) {
            return false;
        }
        segment_ = segment;
        stack_.count = 0;
        stack_.current = 0;
        is_blocked = false;
        prefetch(tree, 0);
        return true;
    }

    HWY_INLINE bool step(const WideTree& tree, const geometry::MeshView& mesh) {
        bool has_next = false;
        if (is_leaf(stack_.current)) {
            DecodeBuffer buffer;
            is_blocked = touches_leaf(
                decode_leaf(tree, stack_.current, buffer), ray_, mesh, segment_, excluded_);
            has_next = !is_blocked && stack_.pop(ray_.t_max);
        } else {
            has_next = descend(tree.nodes()[stack_.current],
                               SlabTestSkippingCoplanar(ray_, excluded_plane_),
                               ray_.order_shift,
                               ray_.t_max,
                               stack_);
        }
        if (has_next) {
            prefetch(tree, stack_.current);
        }
        return has_next;
    }

    /// Excludes the triangle that the segment starts from.
    HWY_INLINE void exclude(const geometry::MeshView& mesh, std::uint32_t triangle) {
        excluded_ = triangle;
        excluded_plane_ = ExcludedPlane(mesh, triangle);
    }

    std::size_t index = 0;
    bool is_blocked = false;

private:
    std::uint32_t excluded_ = kNoTriangle;
    ExcludedPlane excluded_plane_;
    FloatRay ray_;
    geometry::Segment segment_;
    TraversalStack stack_;
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
