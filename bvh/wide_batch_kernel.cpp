// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_batch_kernel.h"

#include "earshot/bvh/internal/ray_packet.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/bvh/wide_batch_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/bvh/kernels/exact_queue-inl.h"
#include "earshot/bvh/kernels/interleaved-inl.h"
#include "earshot/bvh/kernels/packet-inl.h"
#include "earshot/bvh/kernels/packet_gather-inl.h"
#include "earshot/bvh/kernels/small_mesh-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

// The packet traversal of fewer rays is slower than their interleaved traversal.
constexpr std::size_t kMinPacketRays = 12;

HWY_INLINE void closest_interleaved(const WideTree& tree,
                                    const geometry::MeshView& mesh,
                                    const SecondaryRays& secondary_rays,
                                    std::size_t begin,
                                    std::size_t end,
                                    std::span<std::optional<geometry::Hit>> hits,
                                    ExactTestQueue& queue) {
    if (secondary_rays.origin_triangles.empty()) {
        ClosestInterleaved<false> rays(tree, mesh, secondary_rays, begin, end, hits, queue);
        traverse_interleaved(tree, rays);
    } else {
        ClosestInterleaved<true> rays(tree, mesh, secondary_rays, begin, end, hits, queue);
        traverse_interleaved(tree, rays);
    }
}

HWY_INLINE void any_interleaved(const WideTree& tree,
                                const geometry::MeshView& mesh,
                                const SecondarySegments& secondary_segments,
                                std::span<std::uint8_t> blocked) {
    if (secondary_segments.origin_triangles.empty()) {
        AnyInterleaved<false> rays(tree, mesh, secondary_segments, blocked);
        traverse_interleaved(tree, rays);
    } else {
        AnyInterleaved<true> rays(tree, mesh, secondary_segments, blocked);
        traverse_interleaved(tree, rays);
    }
}

/// The closest hits of rays of which consecutive ones may have a common origin.
void closest_in_packets(const WideTree& tree,
                        const geometry::MeshView& mesh,
                        const SecondaryRays& secondary_rays,
                        std::span<std::optional<geometry::Hit>> hits,
                        ExactTestQueue& queue) {
    const auto reach = static_cast<float>(tree.max_abs_coordinate());
    const std::span<const geometry::Ray> rays = secondary_rays.rays;
    RayPacket packet;
    // After rays that form no packet, more rays are traversed interleaved before the next attempt.
    // After a packet whose traversal was abandoned because it visits too many leaves, smaller
    // packets are attempted.
    constexpr std::size_t kMinInterleavedRays = 8;
    constexpr std::size_t kMaxInterleavedRays = 1024;
    std::size_t interleaved_rays = kMinInterleavedRays;
    std::size_t max_rays = RayPacket::kMaxRays;
    for (std::size_t done = 0; done < rays.size();) {
        const auto next = rays.subspan(done, std::min(max_rays, rays.size() - done));
        const std::size_t count = gather_packet(packet, next, reach);
        if (count < kMinPacketRays) {
            const std::size_t end = std::min(done + interleaved_rays, rays.size());
            closest_interleaved(tree, mesh, secondary_rays, done, end, hits, queue);
            done = end;
            interleaved_rays = std::min(4 * interleaved_rays, kMaxInterleavedRays);
            max_rays = std::max(max_rays, 2 * kMinPacketRays);
            continue;
        }
        for (std::size_t i = 0; i < count; ++i) {
            std::optional<geometry::Hit>* const hit = hits.data() + done + i;
            __builtin_prefetch(hit + RayPacket::kMaxRays, 1);
            hit->reset();
        }
        const auto spill = [&](std::size_t ray, std::uint32_t triangle) {
            queue.push(done + ray, triangle);
        };
        if (traverse_packet(tree, packet, spill)) {
            for_each_candidate(packet, spill);
            interleaved_rays = kMinInterleavedRays;
            max_rays = std::min(2 * max_rays, RayPacket::kMaxRays);
        } else {
            closest_interleaved(tree, mesh, secondary_rays, done, done + count, hits, queue);
            interleaved_rays = kMaxInterleavedRays;
            max_rays = count / 2;
        }
        done += count;
    }
}

void closest_of_many(const WideTree& tree,
                     const geometry::MeshView& mesh,
                     const SecondaryRays& secondary_rays,
                     std::span<std::optional<geometry::Hit>> hits) {
    ExactTestQueue queue(mesh, secondary_rays.rays, hits, tree.max_abs_coordinate());
    if (mesh.triangles.size() <= kMaxSmallMeshTriangles) {
        SmallMeshClosest small_mesh(mesh, secondary_rays.rays, hits, queue);
        for (std::size_t i = 0; i < secondary_rays.rays.size(); ++i) {
            small_mesh.add(i);
        }
        small_mesh.finish();
    } else if (secondary_rays.origin_triangles.empty()) {
        closest_in_packets(tree, mesh, secondary_rays, hits, queue);
    } else {
        closest_interleaved(tree, mesh, secondary_rays, 0, secondary_rays.rays.size(), hits, queue);
    }
    queue.finish();
}

void any_of_many(const WideTree& tree,
                 const geometry::MeshView& mesh,
                 const SecondarySegments& secondary_segments,
                 std::span<std::uint8_t> blocked) {
    if (mesh.triangles.size() <= kMaxSmallMeshTriangles) {
        SmallMeshAny small_mesh(tree, mesh, secondary_segments, blocked);
        for (std::size_t i = 0; i < secondary_segments.segments.size(); ++i) {
            small_mesh.add(i);
        }
        small_mesh.finish();
    } else {
        any_interleaved(tree, mesh, secondary_segments, blocked);
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
                          const SecondaryRays& secondary_rays,
                          std::span<std::optional<geometry::Hit>> hits) noexcept {
    HWY_DYNAMIC_DISPATCH(closest_of_many)(tree, mesh, secondary_rays, hits);
}

void find_any_of_many(const WideTree& tree,
                      const geometry::MeshView& mesh,
                      const SecondarySegments& secondary_segments,
                      std::span<std::uint8_t> blocked) noexcept {
    HWY_DYNAMIC_DISPATCH(any_of_many)(tree, mesh, secondary_segments, blocked);
}

}  // namespace earshot::bvh
#endif
