// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/box_pairs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/collision/broad_phase/box_pairs_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/collision/broad_phase/internal/box_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::collision::HWY_NAMESPACE {

/// Which slots of a node may overlap the other box or triangle.
HWY_INLINE std::uint32_t overlapping_slots(const BoxNode& node,
                                           const Slot& other,
                                           std::span<const Corners> other_corners,
                                           const RelativeFrame& frame,
                                           bool is_aligned) {
    return other.is_triangle()
               ? overlapping(node, RelativeTriangle(other, other_corners, frame), frame.padding)
               : overlapping(node, other, frame, is_aligned);
}

/// Prefetches what a child will be tested with: its node, or its triangle's corners.
HWY_INLINE void prefetch(std::span<const BoxNode> nodes,
                         std::span<const Corners> corners,
                         std::uint32_t child) {
    if ((child & kTriangleFlag) != 0) {
        const Corners& own = corners[child & ~kTriangleFlag];
        __builtin_prefetch(&own.front());
        __builtin_prefetch(&own.back());
        return;
    }
    const auto* const address = reinterpret_cast<const std::byte*>(&nodes[child]);
    for (std::size_t line = 0; line < sizeof(BoxNode); line += 64) {
        __builtin_prefetch(address + line);
    }
}

/// Lists the pairs that a pair is expanded into; returns how many boxes were tested. Precondition:
/// it is not of two triangles.
template <typename Visit>
HWY_INLINE std::uint32_t expand(const BoxPairs& trees, BoxPair pair, Visit&& visit) {
    const Slot a(trees.a, pair.a);
    const Slot b(trees.b, pair.b);
    const RelativePose& pose = trees.pose;
    if (expands_first(a, b)) {
        for_each_bit(
            overlapping_slots(trees.a[a.child], b, trees.b_corners, pose.b_in_a, pose.is_aligned),
            [&](std::uint32_t slot) {
                prefetch(trees.a, trees.a_corners, trees.a[a.child].child[slot]);
                visit(BoxPair{a.child * 8 + slot, pair.b});
            });
        return trees.a[a.child].count;
    }
    for_each_bit(
        overlapping_slots(trees.b[b.child], a, trees.a_corners, pose.a_in_b, pose.is_aligned),
        [&](std::uint32_t slot) {
            prefetch(trees.b, trees.b_corners, trees.b[b.child].child[slot]);
            visit(BoxPair{pair.a, b.child * 8 + slot});
        });
    return trees.b[b.child].count;
}

void overlapping_leaves(const BoxPairs& trees, BoxPair from, ContactSearch& search) {
    std::array<BoxPair, kMaxStackSize> stack;
    std::size_t count = 0;
    bool unfinished = true;
    // Pairs of triangles leave the stack at once, while their corners are in cache.
    const auto take = [&](BoxPair pair) {
        const std::uint32_t a = child_of(trees.a, pair.a);
        const std::uint32_t b = child_of(trees.b, pair.b);
        if ((a & b & kTriangleFlag) == 0) {
            stack[count++] = pair;
        } else {
            unfinished = unfinished && search.add(a & ~kTriangleFlag, b & ~kTriangleFlag);
        }
    };
    std::uint64_t box_tests = 0;
    take(from);
    while (unfinished && count > 0) {
        const BoxPair top = stack[--count];
        box_tests += expand(trees, top, take);
    }
    search.statistics.box_tests += box_tests;
}

void expanded(const BoxPairs& trees,
              BoxPair pair,
              std::vector<BoxPair>& out,
              std::uint64_t& box_tests) {
    if ((child_of(trees.a, pair.a) & child_of(trees.b, pair.b) & kTriangleFlag) != 0) {
        out.push_back(pair);
    } else {
        box_tests += expand(trees, pair, [&](BoxPair child) { out.push_back(child); });
    }
}

void self_overlapping(const BoxPairs& trees, std::uint32_t index, ContactSearch& search) {
    const BoxNode& node = trees.a[index];
    for (std::uint32_t slot = 0; slot + 1 < node.count; ++slot) {
        const Slot own(trees.a, index * 8 + slot);
        const std::uint32_t later = ~0U << (slot + 1);
        search.statistics.box_tests += node.count - slot - 1;
        const std::uint32_t mask = overlapping(node, own, trees.pose.a_in_b, true) & later;
        for_each_bit(mask, [&](std::uint32_t other) {
            overlapping_leaves(trees, {index * 8 + slot, index * 8 + other}, search);
        });
    }
}

void closest(const BoxPairs& trees, DistanceSearch& search) {
    struct StackEntry {
        BoxPair pair;
        float squared;
    };
    std::array<StackEntry, kMaxStackSize> stack;
    std::size_t count = 1;
    stack[0] = {{0, 0}, 0.0F};
    while (count > 0) {
        const StackEntry entry = stack[--count];
        const BoxPair pair = entry.pair;
        if (entry.squared > search.squared_bound()) {
            continue;
        }
        const Slot a(trees.a, pair.a);
        const Slot b(trees.b, pair.b);
        if ((a.child & b.child & kTriangleFlag) != 0) {
            search.add(a.child & ~kTriangleFlag, b.child & ~kTriangleFlag);
            continue;
        }
        const bool expands_a = expands_first(a, b);
        search.statistics.box_tests += expands_a ? trees.a[a.child].count : trees.b[b.child].count;
        alignas(64) float squares[8];
        const std::uint32_t mask =
            expands_a
                ? within_distance(
                      trees.a[a.child], b, trees.pose.b_in_a, search.squared_bound(), squares)
                : within_distance(
                      trees.b[b.child], a, trees.pose.a_in_b, search.squared_bound(), squares);
        // Insertion sort: the closest child ends on top of the stack.
        const std::size_t first = count;
        for_each_bit(mask, [&](std::uint32_t slot) {
            if (expands_a) {
                prefetch(trees.a, trees.a_corners, trees.a[a.child].child[slot]);
            } else {
                prefetch(trees.b, trees.b_corners, trees.b[b.child].child[slot]);
            }
            std::size_t top = count++;
            for (; top > first && stack[top - 1].squared < squares[slot]; --top) {
                stack[top] = stack[top - 1];
            }
            stack[top] = {expands_a ? BoxPair{a.child * 8 + slot, pair.b}
                                    : BoxPair{pair.a, b.child * 8 + slot},
                          squares[slot]};
        });
    }
}

}  // namespace earshot::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::collision {

HWY_EXPORT(overlapping_leaves);
HWY_EXPORT(expanded);
HWY_EXPORT(self_overlapping);
HWY_EXPORT(closest);

void traverse_overlapping(const BoxPairs& trees, BoxPair from, ContactSearch& search) {
    HWY_DYNAMIC_DISPATCH(overlapping_leaves)(trees, from, search);
}

std::vector<BoxPair> expand_overlapping(const BoxPairs& trees,
                                        BoxPair pair,
                                        std::uint64_t& box_tests) {
    std::vector<BoxPair> found;
    HWY_DYNAMIC_DISPATCH(expanded)(trees, pair, found, box_tests);
    return found;
}

void traverse_self(const BoxPairs& trees, std::uint32_t node, ContactSearch& search) {
    HWY_DYNAMIC_DISPATCH(self_overlapping)(trees, node, search);
}

void traverse_closest(const BoxPairs& trees, DistanceSearch& search) {
    HWY_DYNAMIC_DISPATCH(closest)(trees, search);
}

}  // namespace earshot::collision
#endif
