// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_batch_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/wide_batch_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/wide.h"
#include "earshot/base/wide_float.h"
#include "earshot/bvh/internal/decision_queue-inl.h"
#include "earshot/bvh/internal/float_ray-inl.h"
#include "earshot/bvh/internal/wide_steps-inl.h"
// After decision_queue-inl.h and wide_steps-inl.h.
#include "earshot/bvh/internal/alone_steps-inl.h"
#include "earshot/bvh/internal/bundle_steps-inl.h"
#include "earshot/bvh/internal/few_triangles-inl.h"
#include "earshot/bvh/internal/stream_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

// A tree that is no larger stays in the processor's second cache, where a ray on its own waits less
// than several in turns mislead the processor about what comes next.
constexpr std::size_t kNearBytes = std::size_t{1} << 20;

// A bundle of fewer rays is slower than as many rays on their own.
constexpr std::size_t kFewest = 12;

/// Rays of which neighbours may start from one point.
void closest_in_bundles(const WideTree& tree,
                        const geometry::MeshView& mesh,
                        const LeavingRays& leaving,
                        std::span<std::optional<geometry::Hit>> hits,
                        DecisionQueue& queue) {
    const double reach = tree.reach();
    const std::span<const geometry::Ray> rays = leaving.rays;
    Bundle bundle;
    // After rays that form no bundle more are taken before the next are looked at; after a bundle
    // that was given up, shorter ones are tried.
    constexpr std::size_t kFirstStretch = 8;
    constexpr std::size_t kLastStretch = 1024;
    std::size_t stretch = kFirstStretch;
    std::size_t most = Bundle::kMost;
    for (std::size_t done = 0; done < rays.size();) {
        const auto next = rays.subspan(done, std::min(most, rays.size() - done));
        const std::size_t count = bundle.take(next, reach);
        if (count < kFewest) {
            const std::size_t end = std::min(done + stretch, rays.size());
            trace_stream(tree, mesh, leaving, done, end, hits, queue);
            done = end;
            stretch = std::min(4 * stretch, kLastStretch);
            most = std::max(most, 2 * kFewest);
            continue;
        }
        if (trace_bundle(tree, mesh, bundle)) {
            for (std::size_t i = 0; i < count; ++i) {
                hits[done + i] = bundle.best(i);
                bundle.for_each_left(
                    i, [&](std::uint32_t triangle) { queue.push(done + i, triangle); });
            }
            stretch = kFirstStretch;
            most = std::min(2 * most, Bundle::kMost);
        } else {
            trace_stream(tree, mesh, leaving, done, done + count, hits, queue);
            stretch = kLastStretch;
            most = count / 2;
        }
        done += count;
    }
}

void closest_of_many(const WideTree& tree,
                     const geometry::MeshView& mesh,
                     const LeavingRays& leaving,
                     std::span<std::optional<geometry::Hit>> hits) {
    DecisionQueue queue(mesh, leaving.rays, hits, tree.reach());
    if (mesh.triangles.size() <= kFewTriangles) {
        ClosestOfFew few(mesh, leaving.rays, hits, queue);
        for (std::size_t i = 0; i < leaving.rays.size(); ++i) {
            few.add(i);
        }
        few.finish();
    } else if (leaving.left.empty()) {
        closest_in_bundles(tree, mesh, leaving, hits, queue);
    } else if (tree.bytes() <= kNearBytes) {
        closest_alone(tree, mesh, leaving, hits, queue);
    } else {
        trace_stream(tree, mesh, leaving, 0, leaving.rays.size(), hits, queue);
    }
    queue.finish();
}

void any_in_stream(const WideTree& tree,
                   const geometry::MeshView& mesh,
                   const LeavingSegments& leaving,
                   std::span<std::uint8_t> blocked) {
    const double reach = tree.reach();
    const std::span<const geometry::Segment> segments = leaving.segments;
    AnyLane lanes[kTogether];
    std::size_t next = 0;
    const auto start = [&](AnyLane& lane) {
        for (; next < segments.size(); ++next) {
            if (lane.start(tree, segments[next], reach)) {
                if (!leaving.left.empty()) {
                    lane.leave(mesh, leaving.left[next]);
                }
                lane.index = next++;
                return true;
            }
            blocked[next] = occluded(tree, mesh, segments[next]) ? 1 : 0;
        }
        return false;
    };
    std::size_t active = 0;
    while (active < kTogether && start(lanes[active])) {
        ++active;
    }
    while (active > 0) {
        for (std::size_t i = 0; i < active;) {
            if (lanes[i].step(tree, mesh)) {
                ++i;
                continue;
            }
            blocked[lanes[i].index] = lanes[i].is_blocked ? 1 : 0;
            if (start(lanes[i])) {
                ++i;
            } else if (--active != i) {
                lanes[i] = lanes[active];
            }
        }
    }
}

void any_of_many(const WideTree& tree,
                 const geometry::MeshView& mesh,
                 const LeavingSegments& leaving,
                 std::span<std::uint8_t> blocked) {
    if (mesh.triangles.size() <= kFewTriangles) {
        AnyOfFew few(tree, mesh, leaving, blocked);
        for (std::size_t i = 0; i < leaving.segments.size(); ++i) {
            few.add(i);
        }
        few.finish();
    } else if (!leaving.left.empty() && tree.bytes() <= kNearBytes) {
        any_alone(tree, mesh, leaving, blocked);
    } else {
        any_in_stream(tree, mesh, leaving, blocked);
    }
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::bvh {

HWY_EXPORT(closest_of_many);
HWY_EXPORT(any_of_many);

void find_closest_of_many(const WideTree& tree,
                          const geometry::MeshView& mesh,
                          const LeavingRays& leaving,
                          std::span<std::optional<geometry::Hit>> hits) noexcept {
    HWY_DYNAMIC_DISPATCH(closest_of_many)(tree, mesh, leaving, hits);
}

void find_any_of_many(const WideTree& tree,
                      const geometry::MeshView& mesh,
                      const LeavingSegments& leaving,
                      std::span<std::uint8_t> blocked) noexcept {
    HWY_DYNAMIC_DISPATCH(any_of_many)(tree, mesh, leaving, blocked);
}

}  // namespace earshot::bvh
#endif
