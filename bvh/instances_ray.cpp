// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/bvh/instances.h"
#include "earshot/bvh/ray.h"
#include "earshot/bvh/wide_ray.h"
#include "earshot/geometry/vector.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::bvh {

using geometry::PreparedRay;
using geometry::Ray;
using geometry::Segment;

namespace {

constexpr std::size_t kGrain = 256;

/// The closest hit among the instances tested so far.
class ClosestInstanceHit {
public:
    ClosestInstanceHit(const Instances& instances, const Ray& ray) noexcept
        : instances_(instances),
          ray_(ray),
          prepared_(ray, max_abs_coordinate(instances.top_level())) {
        t_max_ = prepared_.t_max();
    }

    bool is_valid() const noexcept { return prepared_.is_valid(); }
    double t_max() const noexcept { return t_max_; }
    const std::optional<InstanceHit>& best() const noexcept { return best_; }

    geometry::Interval interval(const Node& node) const noexcept {
        return prepared_.box_interval(node.box, t_max_);
    }

    void test_instance(const Instances::Instance& instance) noexcept {
        const auto interval = prepared_.box_interval(instance.box, prepared_.t_max());
        if (interval.is_empty() || interval.min > t_max_) {
            return;
        }
        // Where the interval ends before the best hit, a hit beyond may still be clamped to its
        // end.
        const double local_t_max = interval.max <= t_max_ ? prepared_.t_max() : t_max_;
        const Instances::Part& part = instances_.part(instance.part);
        const auto hit = closest_hit(part.tree, part.mesh, instance.to_local(ray_, local_t_max));
        if (!hit) {
            return;
        }
        InstanceHit candidate = {instance.id, *hit};
        candidate.hit.t = std::clamp(hit->t, interval.min, interval.max);
        if (candidate.hit.t <= t_max_ && (!best_ || better_hit(candidate, *best_))) {
            best_ = candidate;
            t_max_ = candidate.hit.t;
        }
    }

private:
    const Instances& instances_;
    Ray ray_;
    PreparedRay prepared_;
    std::optional<InstanceHit> best_;
    double t_max_;  // no hit beyond is closest
};

}  // namespace

std::optional<InstanceHit> closest_hit(const Instances& instances, const Ray& ray) noexcept {
    EARSHOT_ASSERT(instances.is_up_to_date());
    struct StackEntry {
        std::uint32_t node = 0;
        double t_near = 0.0;
    };
    const Tree& tree = instances.top_level();
    ClosestInstanceHit search(instances, ray);
    if (tree.nodes().empty() || !search.is_valid()) {
        return std::nullopt;
    }
    // Each inner node on the way down leaves its farther child on the stack.
    std::array<StackEntry, kMaxDepth + 2> stack;
    std::size_t count = 0;
    const auto push = [&](std::uint32_t node, const geometry::Interval& interval) {
        if (!interval.is_empty()) {
            stack[count++] = {node, interval.min};
        }
    };
    push(0, search.interval(tree.nodes()[0]));
    while (count > 0) {
        const StackEntry current = stack[--count];
        // An instance at the distance of the best hit may have a lower id.
        if (current.t_near > search.t_max()) {
            continue;
        }
        const Node& node = tree.nodes()[current.node];
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            search.test_instance(instances.active_instances()[tree.primitives()[i]]);
        }
        if (!node.is_leaf()) {
            const auto left = search.interval(tree.nodes()[node.first]);
            const auto right = search.interval(tree.nodes()[node.first + 1]);
            const bool left_first = left.min <= right.min;
            push(left_first ? node.first + 1 : node.first, left_first ? right : left);
            push(left_first ? node.first : node.first + 1, left_first ? left : right);
        }
    }
    return search.best();
}

bool occluded(const Instances& instances, const Segment& segment) noexcept {
    EARSHOT_ASSERT(instances.is_up_to_date());
    if (!geometry::is_finite(segment.from) || !geometry::is_finite(segment.to)) {
        return false;
    }
    const Tree& tree = instances.top_level();
    const geometry::SlabTest slab_test(
        segment.from, segment.to - segment.from, max_abs_coordinate(tree));
    const auto passes = [&](const geometry::Aabb& box) {
        return !slab_test.interval(box, 1.0).is_empty();
    };
    bool is_blocked = false;
    traverse(
        tree,
        [&](const Node& node) { return passes(node.box); },
        [&](std::uint32_t i) {
            const Instances::Instance& instance = instances.active_instances()[i];
            const Instances::Part& part = instances.part(instance.part);
            is_blocked =
                passes(instance.box) && occluded(part.tree, part.mesh, instance.to_local(segment));
            return !is_blocked;
        });
    return is_blocked;
}

std::vector<std::optional<InstanceHit>> closest_hits(const Instances& instances,
                                                     std::span<const Ray> rays,
                                                     Executor& executor) {
    std::vector<std::optional<InstanceHit>> hits(rays.size());
    executor.for_each(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            hits[i] = closest_hit(instances, rays[i]);
        }
    });
    return hits;
}

std::vector<std::uint8_t> occluded(const Instances& instances,
                                   std::span<const Segment> segments,
                                   Executor& executor) {
    std::vector<std::uint8_t> blocked(segments.size());
    executor.for_each(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            blocked[i] = occluded(instances, segments[i]) ? 1 : 0;
        }
    });
    return blocked;
}

}  // namespace earshot::bvh
