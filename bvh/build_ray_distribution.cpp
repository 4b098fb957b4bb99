// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/builders.h"
#include "earshot/bvh/internal/prim_refs.h"
#include "earshot/geometry/intersect.h"

#include <algorithm>
#include <array>
#include <limits>

namespace earshot::bvh {

using geometry::Aabb;
using geometry::SlabTest;

namespace {

/// Ranges up to this size are left to the surface area heuristic.
constexpr std::uint32_t kSmallRange = 4;

/// A range of the upper levels, and the rays of the sample that hit its box.
struct RayRange {
    BuildRange range;
    std::vector<std::uint32_t> rays{};
};

/// A candidate for the split of a range, with the counts and boxes of both sides.
struct Candidate {
    std::uint32_t axis = 0;
    std::uint32_t first_right_bin = 0;
    std::array<std::uint32_t, 2> counts{};
    std::array<BuildBox, 2> boxes{};
};

std::vector<Candidate> candidates_along(std::uint32_t axis, const Bins& bins, std::uint32_t count) {
    std::array<BuildBox, kMaxBins> rights;
    BuildBox box = empty_bounds().box;
    for (std::uint32_t i = count; i-- > 1;) {
        box = rights[i] = united(box, bins.at[i].boxes[axis]);
    }
    std::uint32_t all = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        all += static_cast<std::uint32_t>(bins.at[i].counts[axis]);
    }
    std::vector<Candidate> candidates;
    std::uint32_t left = 0;
    box = empty_bounds().box;
    for (std::uint32_t i = 1; i < count; ++i) {
        box = united(box, bins.at[i - 1].boxes[axis]);
        left += static_cast<std::uint32_t>(bins.at[i - 1].counts[axis]);
        if (left > 0 && left < all) {
            candidates.push_back({axis, i, {left, all - left}, {box, rights[i]}});
        }
    }
    return candidates;
}

/// Splits ranges level by level as long as rays of the sample hit them; a range that none of them
/// hits becomes a task.
class RayUpperLevels {
public:
    RayUpperLevels(const BuildRange& all,
                   const BuildOptions& options,
                   const SplitRule& rule,
                   Executor& executor)
        : rule_(rule) {
        double max_abs_coordinate = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const BuildBox& box = all.bounds.box;
            max_abs_coordinate = std::max({max_abs_coordinate,
                                           std::abs(static_cast<double>(box.low[k])),
                                           std::abs(static_cast<double>(box.high[k]))});
        }
        RayRange root{all};
        for (const geometry::Segment& ray : options.rays) {
            slab_tests_.emplace_back(ray.from, ray.to - ray.from, max_abs_coordinate);
            root.rays.push_back(static_cast<std::uint32_t>(root.rays.size()));
        }
        root.rays = rays_hitting(all.bounds.box, root.rays);
        std::vector<RayRange> level;
        level.push_back(std::move(root));
        while (!level.empty()) {
            level = split_level(std::move(level), executor);
        }
    }

    std::span<const TopNode> nodes() const { return nodes_; }
    std::span<const BuildRange> tasks() const { return tasks_; }

private:
    std::vector<std::uint32_t> rays_hitting(const BuildBox& box,
                                            const std::vector<std::uint32_t>& rays) const {
        const Aabb bounds = to_aabb(box);
        std::vector<std::uint32_t> hitting;
        for (const std::uint32_t ray : rays) {
            if (!slab_tests_[ray].interval(bounds, 1.0).is_empty()) {
                hitting.push_back(ray);
            }
        }
        return hitting;
    }

    double ratio_hitting(const BuildBox& box, const std::vector<std::uint32_t>& rays) const {
        const Aabb bounds = to_aabb(box);
        const auto count = std::count_if(rays.begin(), rays.end(), [&](std::uint32_t ray) {
            return !slab_tests_[ray].interval(bounds, 1.0).is_empty();
        });
        return static_cast<double>(count) / static_cast<double>(rays.size());
    }

    bool is_task(const RayRange& node) const {
        const std::uint32_t size = node.range.end - node.range.begin;
        return node.rays.empty() || size <= std::max(kSmallRange, rule_.max_leaf_size) ||
               node.range.depth >= kMedianSplitDepth;
    }

    std::vector<RayRange> split_level(std::vector<RayRange> level, Executor& executor) {
        std::vector<std::array<RayRange, 2>> children(level.size());
        executor.for_each(level.size(), 1, [&](std::size_t i, std::size_t) {
            if (!is_task(level[i])) {
                children[i] = split(level[i]);
            }
        });
        // The nodes of a level are contiguous, and their children in the same order.
        const auto next = static_cast<std::uint32_t>(nodes_.size() + level.size());
        std::vector<RayRange> below;
        for (std::size_t i = 0; i < level.size(); ++i) {
            TopNode& node = nodes_.emplace_back();
            if (is_task(level[i])) {
                node.task = static_cast<std::uint32_t>(tasks_.size());
                tasks_.push_back(level[i].range);
                continue;
            }
            node.box = to_aabb(level[i].range.bounds.box);
            node.left = next + static_cast<std::uint32_t>(below.size());
            below.push_back(std::move(children[i][0]));
            below.push_back(std::move(children[i][1]));
        }
        return below;
    }

    std::array<RayRange, 2> split(const RayRange& node) const {
        const BuildRange& range = node.range;
        const std::uint32_t size = range.end - range.begin;
        PrimRef* const refs = range.refs[range.buffer] + range.begin;
        const Binning binning = choose_binning(rule_, range.bounds, size);
        Bins bins;
        fill_bins(refs, size, binning, bins);
        const Candidate best = best_candidate(node, bins, binning.bins);
        std::array<RayRange, 2> children = {RayRange{range}, RayRange{range}};
        BuildRange& left = children[0].range;
        BuildRange& right = children[1].range;
        left.depth = right.depth = range.depth + 1;
        if (best.first_right_bin == 0) {
            const auto half =
                static_cast<std::uint32_t>(split_at_median(refs, size, range.bounds.box));
            left.end = right.begin = range.begin + half;
            left.bounds = bounds_of({refs, half});
            right.bounds = bounds_of({refs + half, size - half});
        } else {
            left.end = right.begin = range.begin + best.counts[0];
            left.buffer = right.buffer = 1 - range.buffer;
            PrimRef* const target = range.refs[left.buffer];
            std::array<BuildBox, 2> centroids;
            Split best_split{};
            best_split.axis = best.axis;
            best_split.first_right_bin = best.first_right_bin;
            partition({refs, size, target + left.begin, target + right.begin},
                      binning,
                      best_split,
                      centroids.data());
            left.bounds = {best.boxes[0], centroids[0]};
            right.bounds = {best.boxes[1], centroids[1]};
        }
        for (RayRange& child : children) {
            child.rays = rays_hitting(child.range.bounds.box, node.rays);
        }
        return children;
    }

    /// The cheapest split by the ray distribution heuristic. With w the weight of n rays that hit
    /// the node, a side of area a and m rays is visited with the probability
    ///     P(side) = (1 - w) a(side) / a(node) + w m / n,    w = 0.9 (1 - 1 / (1 + 0.1 n)),
    /// and its cost is P(side) times its count.
    Candidate best_candidate(const RayRange& node,
                             const Bins& bins,
                             std::uint32_t bin_count) const {
        const double area = to_aabb(node.range.bounds.box).half_area();
        const double weight = ray_blend_weight(node.rays.size());
        Candidate best;
        double best_cost = std::numeric_limits<double>::infinity();
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            for (const Candidate& candidate : candidates_along(axis, bins, bin_count)) {
                double by_area = 0.0;
                for (std::size_t side = 0; side < 2; ++side) {
                    const double part = to_aabb(candidate.boxes[side]).half_area();
                    by_area += (area > 0.0 ? part / area : 1.0) * candidate.counts[side];
                }
                double cost = (1.0 - weight) * by_area;
                // Counting rays takes most of the time, and costs only grow.
                for (std::size_t side = 0; side < 2 && cost < best_cost; ++side) {
                    cost += weight * ratio_hitting(candidate.boxes[side], node.rays) *
                            candidate.counts[side];
                }
                if (cost < best_cost) {
                    best_cost = cost;
                    best = candidate;
                }
            }
        }
        return best;
    }

    SplitRule rule_;
    std::vector<SlabTest> slab_tests_;  // per ray
    std::vector<TopNode> nodes_;
    std::vector<BuildRange> tasks_;
};

}  // namespace

double ray_blend_weight(std::size_t rays) noexcept {
    constexpr double kAlpha = 0.9, kBeta = 0.1;  // as published
    return kAlpha * (1.0 - 1.0 / (1.0 + kBeta * static_cast<double>(rays)));
}

// Bittner and Havran 2009: in a node that rays of the sample hit, the probability that a side is
// visited is blended from the ratio of these rays that hit it and the ratio of the areas. They
// build a kd-tree; here candidates are the splits between bins, and rays are tested against the
// boxes that the children would have. Leaves are made by the surface area heuristic alone, so no
// ray from elsewhere finds a large one.
Tree build_ray_distribution(std::span<const Aabb> boxes,
                            const BuildOptions& options,
                            Executor& executor) {
    PrimRefs refs(boxes, executor);
    if (refs.are_clamped()) {
        return build_binned_sah(boxes, options, executor);  // too far for counting
    }
    const SplitRule rule = {.max_leaf_size = static_cast<std::uint32_t>(options.max_leaf_size),
                            .traversal_cost = static_cast<float>(options.traversal_cost)};
    const RayUpperLevels top(refs.root_range(), options, rule, executor);
    return refs.build_tree(top.nodes(), top.tasks(), rule, executor);
}

}  // namespace earshot::bvh
