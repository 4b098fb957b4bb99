// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/prim_refs.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

/// Twice the centroid, as the box of a single point.
BuildBox centroid_box(const BuildBox& box) {
    BuildBox centroid;
    for (std::size_t k = 0; k < 4; ++k) {
        centroid.low[k] = box.low[k] - box.high[k];
        centroid.high[k] = box.high[k] - box.low[k];
    }
    return centroid;
}

// When a subtree is built, its references are not needed any more, and their two arrays have room
// for all of its nodes: the first nodes overwrite refs[0], the others refs[1].

void store_nodes(const BuildRange& range, const RawNode* nodes, std::uint32_t count) {
    static_assert(sizeof(RawNode) == sizeof(BuildBox));
    const std::uint32_t size = range.end - range.begin;
    const std::uint32_t first = std::min(count, size);
    std::memcpy(static_cast<void*>(range.refs[0] + range.begin), nodes, first * sizeof(RawNode));
    std::memcpy(static_cast<void*>(range.refs[1] + range.begin),
                nodes + first,
                (count - first) * sizeof(RawNode));
}

RawNode load_node(const BuildRange& range, std::uint32_t index) {
    const std::uint32_t size = range.end - range.begin;
    const PrimRef* const storage = index < size ? range.refs[0] + range.begin + index
                                                : range.refs[1] + range.begin + (index - size);
    RawNode node;
    std::memcpy(&node, storage, sizeof(node));
    return node;
}

Node to_node(const RawNode& raw) {
    Node node;
    node.first = raw.first;
    node.count = raw.count;
    std::copy_n(raw.lower, 3, node.box.lower.begin());
    std::copy_n(raw.upper, 3, node.box.upper.begin());
    return node;
}

}  // namespace

BuildBox united(const BuildBox& a, const BuildBox& b) noexcept {
    BuildBox result;
    for (std::size_t k = 0; k < 4; ++k) {
        result.low[k] = std::max(a.low[k], b.low[k]);
        result.high[k] = std::max(a.high[k], b.high[k]);
    }
    return result;
}

Bounds united(const Bounds& a, const Bounds& b) noexcept {
    return {united(a.box, b.box), united(a.centroids, b.centroids)};
}

Bounds empty_bounds() noexcept {
    constexpr float kLowest = -std::numeric_limits<float>::max();
    constexpr BuildBox kNothing = {{kLowest, kLowest, kLowest, kLowest},
                                   {kLowest, kLowest, kLowest, kLowest}};
    return {kNothing, kNothing};
}

Bounds bounds_of(std::span<const PrimRef> refs) noexcept {
    Bounds bounds = empty_bounds();
    for (const PrimRef& ref : refs) {
        bounds = united(bounds, {ref, centroid_box(ref)});
    }
    return bounds;
}

Aabb to_aabb(const BuildBox& box) noexcept {
    Aabb result;
    for (std::size_t k = 0; k < 3; ++k) {
        result.lower[k] = 0.0F - box.low[k];
        result.upper[k] = box.high[k];
    }
    return result;
}

PrimRefs::PrimRefs(std::span<const Aabb> boxes, Executor& executor)
    : boxes_(boxes),
      arrays_{LargeArray<PrimRef>(boxes.size()), LargeArray<PrimRef>(boxes.size())},
      bounds_(empty_bounds()) {
    constexpr std::size_t kGrain = 16384;
    std::vector<Bounds> chunks(chunk_count(boxes.size(), kGrain));
    executor.for_each(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        make_prim_refs(boxes[begin].lower.data(),
                       static_cast<std::uint32_t>(begin),
                       end - begin,
                       arrays_[0].data() + begin,
                       chunks[begin / kGrain]);
    });
    for (const Bounds& chunk : chunks) {
        bounds_ = united(bounds_, chunk);
    }
}

BuildRange PrimRefs::root_range() noexcept {
    return {.refs = {arrays_[0].data(), arrays_[1].data()},
            .begin = 0,
            .end = static_cast<std::uint32_t>(boxes_.size()),
            .buffer = 0,
            .depth = 0,
            .bounds = bounds_};
}

bool PrimRefs::are_clamped() const noexcept {
    const BuildBox& box = bounds_.box;
    return std::max(*std::max_element(box.low, box.low + 3),
                    *std::max_element(box.high, box.high + 3)) >= kMaxCoordinate;
}

Tree PrimRefs::build_tree(std::span<const TopNode> top,
                          std::span<const BuildRange> tasks,
                          const SplitRule& rule,
                          Executor& executor) const {
    auto primitives = vector_on_touched_pages<std::uint32_t>(boxes_.size(), executor);
    std::vector<std::uint32_t> counts(tasks.size());
    executor.for_each(counts.size(), 1, [&](std::size_t task, std::size_t) {
        const BuildRange& range = tasks[task];
        LargeArray<RawNode> nodes(2 * static_cast<std::size_t>(range.end - range.begin));
        counts[task] = build_subtree(range, rule, nodes.data(), primitives.data());
        store_nodes(range, nodes.data(), counts[task]);
    });
    const auto node_of = [&](std::uint32_t task, std::uint32_t index) {
        return to_node(load_node(tasks[task], index));
    };
    Tree tree = Tree::from_nodes(TreeAssembly(top, counts, node_of, executor).nodes(executor),
                                 std::move(primitives));
    if (are_clamped()) {
        tree.refit(boxes_, executor);
    }
    return tree;
}

std::size_t split_at_median(PrimRef* refs, std::size_t count, const BuildBox& box) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (box.low[k] + box.high[k] > box.low[axis] + box.high[axis]) {
            axis = k;
        }
    }
    const std::size_t middle = count / 2;
    std::nth_element(refs, refs + middle, refs + count, [&](const BuildBox& a, const BuildBox& b) {
        const float ca = doubled_centroid(a, axis);
        const float cb = doubled_centroid(b, axis);
        return ca != cb ? ca < cb : primitive_index(a) < primitive_index(b);
    });
    return middle;
}

}  // namespace earshot::bvh
