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

/// Fetches what will be visited next, without a branch on what that is.
HWY_INLINE void prefetch(const WideTree& tree, std::uint32_t child) {
    const std::uint64_t leaf_mask = std::uint64_t{0} - (child >> 31);
    const auto node = reinterpret_cast<std::uint64_t>(tree.nodes().data()) +
                      sizeof(WideNode) * std::uint64_t{child};
    const auto leaf = reinterpret_cast<std::uint64_t>(tree.packed_leaf(child));
    const auto* address = reinterpret_cast<const char*>((node & ~leaf_mask) | (leaf & leaf_mask));
    for (std::size_t line = 0; line < sizeof(WideNode); line += 64) {
        __builtin_prefetch(address + line);
    }
    // A leaf does not begin at a line, so it may reach into a fifth.
    __builtin_prefetch(address + 192 + (64 & leaf_mask));
}

/// A ray in flight.
struct RayInFlight {
    FloatRay ray;
    std::size_t index = 0;
    std::uint32_t excluded = kNoTriangle;
    ExcludedPlane excluded_plane;
    TraversalStack stack;

    HWY_INLINE void exclude(const geometry::MeshView& mesh, std::uint32_t triangle) {
        excluded = triangle;
        excluded_plane = ExcludedPlane(mesh, triangle);
    }
};

/// The rays in flight that visit a node next, or a leaf.
template <std::size_t kCapacity>
struct FlightList {
    std::size_t count = 0;
    std::uint32_t at[kCapacity];

    /// Without a branch: the next ray overwrites what is not kept.
    HWY_INLINE void push_if(std::uint32_t is_kept, std::uint32_t flight) {
        at[count] = flight;
        count += is_kept;
    }
};

/// A tree that is no larger stays in the processor's L2 cache. There is less latency to hide then
/// than prefetches cost.
inline constexpr std::size_t kL2CacheBytes = std::size_t{1} << 20;

/// Advances rays until all are finished. In every round each ray whose next is a node visits one
/// node, and then leaves are visited until none is next. So no branch depends on what a ray visits
/// next, and while the memory fetches that, the other rays advance. `Rays` holds the rays and what
/// is asked of them: start(flight) sets up the next ray, or returns false after the last;
/// enter(flight, node) pushes children; visit(flight, leaf) returns false if the leaf ends the
/// search; pop(flight) returns false if there is nothing more to visit; finish(flight).
template <typename Rays>
HWY_INLINE void traverse_interleaved(const WideTree& tree, Rays& rays) {
    constexpr std::size_t kFlights = Rays::kFlights;
    using Flight = typename Rays::Flight;
    const bool prefetches = tree.bytes() > kL2CacheBytes;
    Flight flights[kFlights];
    FlightList<kFlights + 1> nodes, leaves;
    while (nodes.count < kFlights && rays.start(flights[nodes.count])) {
        nodes.push_if(1, static_cast<std::uint32_t>(nodes.count));
    }
    // Finishes a ray and starts the next in its place.
    const auto replace = [&](std::uint32_t k) __attribute__((noinline)) {
        rays.finish(flights[k]);
        return rays.start(flights[k]);
    };
    // Goes on with a ray or its replacement; sorts it by what is next.
    const auto advance = [&](std::uint32_t k, bool has_next) __attribute__((always_inline)) {
        if (!has_next && !replace(k)) {
            return;
        }
        const std::uint32_t next = flights[k].stack.current;
        if (prefetches) {
            prefetch(tree, next);
        }
        leaves.push_if(next >> 31, k);
        nodes.push_if(1 - (next >> 31), k);
    };
    while (nodes.count > 0) {
        const std::size_t node_count = nodes.count;
        nodes.count = 0;
        for (std::size_t i = 0; i < node_count; ++i) {
            const std::uint32_t k = nodes.at[i];
            rays.enter(flights[k], tree.nodes()[flights[k].stack.current]);
            advance(k, rays.pop(flights[k]));
        }
        while (leaves.count > 0) {
            const std::size_t visited = leaves.count;
            leaves.count = 0;
            for (std::size_t i = 0; i < visited; ++i) {
                const std::uint32_t k = leaves.at[i];
                DecodeBuffer buffer;
                const bool goes_on =
                    rays.visit(flights[k], decode_leaf(tree, flights[k].stack.current, buffer));
                advance(k, goes_on && rays.pop(flights[k]));
            }
        }
    }
}

/// The searches for the closest hits of rays [next, end); the queue decides the last candidates.
template <bool kIsSecondary>
class ClosestInterleaved {
public:
    static constexpr std::size_t kFlights = 24;

    struct Flight : RayInFlight {
        std::optional<ClosestHitSearch> search;
    };

    ClosestInterleaved(const WideTree& tree,
                       const geometry::MeshView& mesh,
                       const SecondaryRays& secondary_rays,
                       std::size_t begin,
                       std::size_t end,
                       std::span<std::optional<geometry::Hit>> hits,
                       ExactTestQueue& queue)
        : tree_(tree),
          mesh_(mesh),
          secondary_rays_(secondary_rays),
          reach_(tree.max_abs_coordinate()),
          next_(begin),
          end_(end),
          hits_(hits),
          queue_(queue) {}

    HWY_INLINE bool start(Flight& flight) {
        for (; next_ < end_; ++next_) {
            const geometry::Ray& ray = secondary_rays_.rays[next_];
            if (set_ray(flight.ray, ray, static_cast<float>(reach_))) {
                __builtin_prefetch(&ray + kFetchDistance);
                if constexpr (kIsSecondary) {
                    flight.exclude(mesh_, secondary_rays_.origin_triangles[next_]);
                }
                flight.search.emplace(mesh_, ray, reach_);
                flight.search->bound = flight.ray.t_max;
                flight.stack.count = 0;
                flight.stack.current = 0;
                flight.index = next_++;
                return true;
            }
            hits_[next_] = closest_hit(tree_, mesh_, ray);
        }
        return false;
    }
    HWY_INLINE void enter(Flight& flight, const WideNode& node) const {
        const Float8 bound = Float8(flight.search->bound);
        flight.stack.push(intervals(flight, node, bound), node, flight.ray.order_shift);
    }
    HWY_INLINE bool pop(Flight& flight) const { return flight.stack.pop_any(); }
    HWY_INLINE bool visit(Flight& flight, const LeafTriangles& leaf) const {
        visit_leaf<EarlyExit::no>(leaf, flight.ray, *flight.search, flight.excluded);
        flight.stack.remove_beyond(flight.search->bound);
        return true;
    }
    HWY_INLINE void finish(const Flight& flight) {
        hits_[flight.index] = flight.search->best();
        flight.search->for_each_pending(
            [&](std::uint32_t triangle) { queue_.push(flight.index, triangle); });
    }

private:
    static constexpr std::size_t kFetchDistance = 8;

    HWY_INLINE static SlabIntervals intervals(const Flight& flight,
                                              const WideNode& node,
                                              const Float8& bound) {
        if constexpr (kIsSecondary) {
            return SlabTestSkippingCoplanar(flight.ray, flight.excluded_plane)(node, bound);
        } else {
            return SlabTest(flight.ray)(node, bound);
        }
    }

    const WideTree& tree_;
    const geometry::MeshView& mesh_;
    const SecondaryRays& secondary_rays_;
    double reach_;
    std::size_t next_, end_;
    std::span<std::optional<geometry::Hit>> hits_;
    ExactTestQueue& queue_;
};

/// The searches of segments for any touch.
template <bool kIsSecondary>
class AnyInterleaved {
public:
    static constexpr std::size_t kFlights = 32;

    struct Flight : RayInFlight {
        bool is_blocked = false;
    };

    AnyInterleaved(const WideTree& tree,
                   const geometry::MeshView& mesh,
                   const SecondarySegments& secondary_segments,
                   std::span<std::uint8_t> blocked)
        : tree_(tree),
          mesh_(mesh),
          secondary_segments_(secondary_segments),
          reach_(static_cast<float>(tree.max_abs_coordinate())),
          blocked_(blocked) {}

    HWY_INLINE bool start(Flight& flight) {
        const std::span<const geometry::Segment> segments = secondary_segments_.segments;
        for (; next_ < segments.size(); ++next_) {
            if (set_segment(flight.ray, segments[next_], reach_)) {
                __builtin_prefetch(segments.data() + next_ + kFetchDistance);
                if constexpr (kIsSecondary) {
                    flight.exclude(mesh_, secondary_segments_.origin_triangles[next_]);
                }
                flight.is_blocked = false;
                flight.stack.count = 0;
                flight.stack.current = 0;
                flight.index = next_++;
                return true;
            }
            blocked_[next_] = occluded(tree_, mesh_, segments[next_]) ? 1 : 0;
        }
        return false;
    }
    HWY_INLINE void enter(Flight& flight, const WideNode& node) const {
        const Float8 end = Float8(1.0F);
        // Any hit will do, so the order of the children does not matter.
        if constexpr (kIsSecondary) {
            flight.stack.push_unordered(
                SlabTestSkippingCoplanar(flight.ray, flight.excluded_plane)(node, end), node);
        } else {
            flight.stack.push_unordered(SlabTest(flight.ray)(node, end), node);
        }
    }
    HWY_INLINE bool pop(Flight& flight) const { return flight.stack.pop_any(); }
    HWY_INLINE bool visit(Flight& flight, const LeafTriangles& leaf) const {
        flight.is_blocked = touches_leaf<EarlyExit::no>(
            leaf, flight.ray, mesh_, secondary_segments_.segments[flight.index], flight.excluded);
        return !flight.is_blocked;
    }
    HWY_INLINE void finish(const Flight& flight) {
        blocked_[flight.index] = flight.is_blocked ? 1 : 0;
    }

private:
    static constexpr std::size_t kFetchDistance = 8;

    const WideTree& tree_;
    const geometry::MeshView& mesh_;
    const SecondarySegments& secondary_segments_;
    float reach_;
    std::size_t next_ = 0;
    std::span<std::uint8_t> blocked_;
};

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
