// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/traverse_wide.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"
#include "earshot/geometry/closest_point.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/overlap.h"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace earshot::bvh {

/// A mesh in its current pose and the hierarchy over its triangles, as one object that answers
/// queries: a view of both, which their owner keeps; see DeformableBvh::view(). Answers depend on
/// the mesh alone, never on the tree. May be queried from many threads.
class MeshBvh {
public:
    /// Precondition: the tree was built over or refitted to this mesh. Both must outlive the view.
    MeshBvh(const WideTree& tree, const geometry::MeshView& mesh) noexcept
        : tree_(&tree), mesh_(mesh) {}

    const WideTree& tree() const noexcept { return *tree_; }
    const geometry::MeshView& mesh() const noexcept { return mesh_; }
    geometry::Corners corners(geometry::TriangleId id) const noexcept {
        return geometry::corners(mesh_, id);
    }
    /// The largest absolute coordinate of the mesh's box, metres; 0 without triangles.
    double max_abs_coordinate() const noexcept { return tree_->max_abs_coordinate(); }

    /// See wide_ray.h.
    std::optional<geometry::Hit> closest_hit(const geometry::Ray& ray) const noexcept {
        return bvh::closest_hit(*tree_, mesh_, ray);
    }
    bool occluded(const geometry::Segment& segment) const noexcept {
        return bvh::occluded(*tree_, mesh_, segment);
    }

    /// Whether a triangle shares a point with the closed segment and `accept(triangle, t)` holds
    /// for it: see any_hit() of ray.h.
    template <std::predicate<geometry::TriangleId, double> Accept>
    bool any_hit(const geometry::Segment& segment, Accept&& accept) const {
        // The end may lie a rounding past 1, which is less than the padding of SlabTest.
        const geometry::SlabTest slab_test(
            segment.from, segment.to - segment.from, max_abs_coordinate());
        bool is_accepted = false;
        traverse(
            [&](const geometry::Aabb& box) { return !slab_test.interval(box, 1.0).is_empty(); },
            [&](geometry::TriangleId id) {
                const auto [a, b, c] = corners(id);
                const auto touch = geometry::first_touch(segment, a, b, c);
                is_accepted = touch && accept(id, *touch);
                return !is_accepted;
            });
        return is_accepted;
    }

    /// Batches: see wide_batch.h.
    std::vector<std::optional<geometry::Hit>> closest_hits(
        std::span<const geometry::Ray> rays, Executor& executor = Executor::serial()) const {
        return bvh::closest_hits(*tree_, mesh_, rays, executor);
    }
    bool closest_hits(std::span<const geometry::Ray> rays,
                      std::span<std::optional<geometry::Hit>> hits,
                      Executor& executor = Executor::serial(),
                      const Interrupt& interrupt = {}) const {
        return bvh::closest_hits(*tree_, mesh_, rays, hits, executor, interrupt);
    }
    void closest_hits(const SecondaryRays& secondary,
                      std::span<std::optional<geometry::Hit>> hits) const {
        bvh::closest_hits(*tree_, mesh_, secondary, hits);
    }
    std::vector<std::uint8_t> occluded(std::span<const geometry::Segment> segments,
                                       Executor& executor = Executor::serial()) const {
        return bvh::occluded(*tree_, mesh_, segments, executor);
    }
    bool occluded(std::span<const geometry::Segment> segments,
                  std::span<std::uint8_t> blocked,
                  Executor& executor = Executor::serial(),
                  const Interrupt& interrupt = {}) const {
        return bvh::occluded(*tree_, mesh_, segments, blocked, executor, interrupt);
    }
    void occluded(const SecondarySegments& secondary, std::span<std::uint8_t> blocked) const {
        bvh::occluded(*tree_, mesh_, secondary, blocked);
    }

    /// The closest point of the mesh: see closest_point.h. Does not allocate.
    std::optional<geometry::ClosestPoint> closest_point(
        const geometry::Vec3& point,
        double max_distance = std::numeric_limits<double>::infinity()) const noexcept;

    /// All triangles that the region touches, ascending: see overlap.h.
    template <geometry::OverlapRegion Region>
    std::vector<geometry::TriangleId> overlapping(const Region& region) const {
        std::vector<geometry::TriangleId> found;
        traverse([&](const geometry::Aabb& box) { return region.may_touch(box); },
                 [&](geometry::TriangleId id) {
                     const auto [a, b, c] = corners(id);
                     if (region.touches(a, b, c)) {
                         found.push_back(id);
                     }
                     return true;
                 });
        std::sort(found.begin(), found.end());
        return found;
    }

    /// See traverse_wide.h.
    template <std::predicate<const geometry::Aabb&> Overlaps,
              std::predicate<geometry::TriangleId> Visit>
    void traverse(Overlaps&& overlaps, Visit&& visit) const {
        bvh::traverse(*tree_, std::forward<Overlaps>(overlaps), std::forward<Visit>(visit));
    }

private:
    const WideTree* tree_;
    geometry::MeshView mesh_;
};

}  // namespace earshot::bvh
