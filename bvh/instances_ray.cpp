// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/bvh/instances.h"
#include "earshot/bvh/ray.h"
#include "earshot/bvh/wide_ray.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::bvh {

using geometry::PreparedRay;
using geometry::Ray;
using geometry::Segment;

namespace {

constexpr std::size_t kGrain = 256;

bool is_finite(const geometry::Vec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Looks for the closest hit among instances.
class Search {
public:
    Search(const Instances& scene, const Ray& ray) noexcept
        : scene_(scene), ray_(ray), prepared_(ray, reach_of(scene.upper_level())) {
        most_ = prepared_.t_max();
    }

    bool is_valid() const noexcept { return prepared_.is_valid(); }
    double most() const noexcept { return most_; }
    const std::optional<InstanceHit>& best() const noexcept { return best_; }

    geometry::Passage passage(const Node& node) const noexcept {
        return prepared_.passage(node.box, most_);
    }

    void try_instance(const Instances::Instance& instance) noexcept {
        const auto own = prepared_.passage(instance.box, prepared_.t_max());
        if (own.is_empty() || own.near > most_) {
            return;
        }
        // A hit beyond the best may still be moved before it if the passage ends there.
        const double bound = own.far <= most_ ? prepared_.t_max() : most_;
        const Instances::Part& part = scene_.part(instance.part);
        auto hit = closest_hit(part.tree, part.mesh, instance.into_part(ray_, bound));
        if (!hit) {
            return;
        }
        hit->t = std::clamp(hit->t, own.near, own.far);
        if (hit->t < most_ || (hit->t == most_ && (!best_ || instance.id < best_->instance))) {
            best_ = InstanceHit{instance.id, *hit};
            most_ = hit->t;
        }
    }

private:
    const Instances& scene_;
    Ray ray_;
    PreparedRay prepared_;
    std::optional<InstanceHit> best_;
    double most_;
};

}  // namespace

std::optional<InstanceHit> closest_hit(const Instances& scene, const Ray& ray) noexcept {
    EARSHOT_ASSERT(scene.is_up_to_date());
    struct Waiting {
        std::uint32_t node = 0;
        double near = 0.0;
    };
    const Tree& tree = scene.upper_level();
    Search search(scene, ray);
    if (tree.nodes().empty() || !search.is_valid()) {
        return std::nullopt;
    }
    // Each inner node leaves one child behind for the time when the nearer one is done.
    std::array<Waiting, kMaxDepth + 2> waiting;
    std::size_t count = 0;
    const auto wait_for = [&](std::uint32_t node, const geometry::Passage& passage) {
        if (!passage.is_empty()) {
            waiting[count++] = {node, passage.near};
        }
    };
    wait_for(0, search.passage(tree.nodes()[0]));
    while (count > 0) {
        const Waiting current = waiting[--count];
        // An instance at the distance of the best hit may have a lower id.
        if (current.near > search.most()) {
            continue;
        }
        const Node& node = tree.nodes()[current.node];
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            search.try_instance(scene.placed()[tree.primitives()[i]]);
        }
        if (!node.is_leaf()) {
            const auto left = search.passage(tree.nodes()[node.first]);
            const auto right = search.passage(tree.nodes()[node.first + 1]);
            const bool left_first = left.near <= right.near;
            wait_for(left_first ? node.first + 1 : node.first, left_first ? right : left);
            wait_for(left_first ? node.first : node.first + 1, left_first ? left : right);
        }
    }
    return search.best();
}

bool occluded(const Instances& scene, const Segment& segment) noexcept {
    EARSHOT_ASSERT(scene.is_up_to_date());
    if (!is_finite(segment.from) || !is_finite(segment.to)) {
        return false;
    }
    const Tree& tree = scene.upper_level();
    const geometry::Slabs slabs(segment.from, segment.to - segment.from, reach_of(tree));
    const auto passes = [&](const geometry::Aabb& box) {
        return !slabs.passage(box, 1.0).is_empty();
    };
    bool is_blocked = false;
    traverse(
        tree,
        [&](const Node& node) { return passes(node.box); },
        [&](std::uint32_t i) {
            const Instances::Instance& instance = scene.placed()[i];
            const Instances::Part& part = scene.part(instance.part);
            is_blocked =
                passes(instance.box) && occluded(part.tree, part.mesh, instance.into_part(segment));
            return !is_blocked;
        });
    return is_blocked;
}

std::vector<std::optional<InstanceHit>> closest_hits(const Instances& scene,
                                                     std::span<const Ray> rays,
                                                     Executor& executor) {
    std::vector<std::optional<InstanceHit>> hits(rays.size());
    executor.for_each(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            hits[i] = closest_hit(scene, rays[i]);
        }
    });
    return hits;
}

std::vector<std::uint8_t> occluded(const Instances& scene,
                                   std::span<const Segment> segments,
                                   Executor& executor) {
    std::vector<std::uint8_t> blocked(segments.size());
    executor.for_each(segments.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            blocked[i] = occluded(scene, segments[i]) ? 1 : 0;
        }
    });
    return blocked;
}

}  // namespace earshot::bvh
