// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/box_pairs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/collision/broad_phase/box_pairs_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/wide_float.h"
#include "earshot/collision/broad_phase/internal/box_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::collision::HWY_NAMESPACE {

/// Which slots of a node the guest may meet.
HWY_INLINE std::uint32_t met(const BoxNode& node,
                             const Slot& guest,
                             std::span<const Corners> guest_corners,
                             const GuestFrame& frame,
                             bool is_aligned) {
    return guest.is_triangle()
               ? overlapping(node, GuestTriangle(guest, guest_corners, frame), frame.padding)
               : overlapping(node, guest, frame, is_aligned);
}

/// Asks memory for what a child will be tested with: its node, or its triangle's corners.
HWY_INLINE void fetch(std::span<const BoxNode> nodes,
                      std::span<const Corners> corners,
                      std::uint32_t child) {
    if ((child & kTriangleFlag) != 0) {
        const Corners& own = corners[child & ~kTriangleFlag];
        __builtin_prefetch(&own.front());
        __builtin_prefetch(&own.back());
        return;
    }
    const auto* const place = reinterpret_cast<const std::byte*>(&nodes[child]);
    for (std::size_t line = 0; line < sizeof(BoxNode); line += 64) {
        __builtin_prefetch(place + line);
    }
}

/// Lists the pairs that a pair is opened into. Precondition: it is not of two triangles.
template <typename Visit>
HWY_INLINE void open(const BoxPairs& trees, BoxPair pair, Visit&& visit) {
    const Slot a(trees.a, pair.a);
    const Slot b(trees.b, pair.b);
    const RelativePose& pose = trees.pose;
    if (is_opened_first(a, b)) {
        for_each_bit(met(trees.a[a.child], b, trees.b_corners, pose.b_in_a, pose.is_aligned),
                     [&](std::uint32_t slot) {
                         fetch(trees.a, trees.a_corners, trees.a[a.child].child[slot]);
                         visit(BoxPair{a.child * 8 + slot, pair.b});
                     });
    } else {
        for_each_bit(met(trees.b[b.child], a, trees.a_corners, pose.a_in_b, pose.is_aligned),
                     [&](std::uint32_t slot) {
                         fetch(trees.b, trees.b_corners, trees.b[b.child].child[slot]);
                         visit(BoxPair{pair.a, b.child * 8 + slot});
                     });
    }
}

void touching(const BoxPairs& trees, BoxPair from, ContactSearch& search) {
    std::array<BoxPair, kMostWaiting> waiting;
    std::size_t count = 0;
    bool goes_on = true;
    // Triangles are decided at once, while what they were found by is still at hand.
    const auto take = [&](BoxPair pair) {
        const std::uint32_t a = child_of(trees.a, pair.a);
        const std::uint32_t b = child_of(trees.b, pair.b);
        if ((a & b & kTriangleFlag) == 0) {
            waiting[count++] = pair;
        } else {
            goes_on = goes_on && search.add(a & ~kTriangleFlag, b & ~kTriangleFlag);
        }
    };
    take(from);
    while (goes_on && count > 0) {
        open(trees, waiting[--count], take);
    }
}

void opened(const BoxPairs& trees, BoxPair pair, std::vector<BoxPair>& out) {
    if ((child_of(trees.a, pair.a) & child_of(trees.b, pair.b) & kTriangleFlag) != 0) {
        out.push_back(pair);
    } else {
        open(trees, pair, [&](BoxPair child) { out.push_back(child); });
    }
}

void touching_within(const BoxPairs& trees, std::uint32_t index, ContactSearch& search) {
    const BoxNode& node = trees.a[index];
    for (std::uint32_t slot = 0; slot + 1 < node.count; ++slot) {
        const Slot own(trees.a, index * 8 + slot);
        const std::uint32_t later = ~0U << (slot + 1);
        const std::uint32_t mask = overlapping(node, own, trees.pose.a_in_b, true) & later;
        for_each_bit(mask, [&](std::uint32_t other) {
            touching(trees, {index * 8 + slot, index * 8 + other}, search);
        });
    }
}

void nearest(const BoxPairs& trees, DistanceSearch& search) {
    struct Waiting {
        BoxPair pair;
        float squared;
    };
    std::array<Waiting, kMostWaiting> waiting;
    std::size_t count = 1;
    waiting[0] = {{0, 0}, 0.0F};
    while (count > 0) {
        const auto [pair, squared] = waiting[--count];
        if (squared > search.squared_bound()) {
            continue;
        }
        const Slot a(trees.a, pair.a);
        const Slot b(trees.b, pair.b);
        if ((a.child & b.child & kTriangleFlag) != 0) {
            search.add(a.child & ~kTriangleFlag, b.child & ~kTriangleFlag);
            continue;
        }
        const bool opens_a = is_opened_first(a, b);
        alignas(64) float squares[8];
        const std::uint32_t mask =
            opens_a
                ? within(trees.a[a.child], b, trees.pose.b_in_a, search.squared_bound(), squares)
                : within(trees.b[b.child], a, trees.pose.a_in_b, search.squared_bound(), squares);
        // The nearest on top.
        const std::size_t first = count;
        for_each_bit(mask, [&](std::uint32_t slot) {
            if (opens_a) {
                fetch(trees.a, trees.a_corners, trees.a[a.child].child[slot]);
            } else {
                fetch(trees.b, trees.b_corners, trees.b[b.child].child[slot]);
            }
            std::size_t place = count++;
            for (; place > first && waiting[place - 1].squared < squares[slot]; --place) {
                waiting[place] = waiting[place - 1];
            }
            waiting[place] = {
                opens_a ? BoxPair{a.child * 8 + slot, pair.b} : BoxPair{pair.a, b.child * 8 + slot},
                squares[slot]};
        });
    }
}

}  // namespace earshot::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::collision {

HWY_EXPORT(touching);
HWY_EXPORT(opened);
HWY_EXPORT(touching_within);
HWY_EXPORT(nearest);

void find_touching(const BoxPairs& trees, BoxPair from, ContactSearch& search) {
    HWY_DYNAMIC_DISPATCH(touching)(trees, from, search);
}

std::vector<BoxPair> open_touching(const BoxPairs& trees, BoxPair pair) {
    std::vector<BoxPair> found;
    HWY_DYNAMIC_DISPATCH(opened)(trees, pair, found);
    return found;
}

void find_touching_within(const BoxPairs& trees, std::uint32_t node, ContactSearch& search) {
    HWY_DYNAMIC_DISPATCH(touching_within)(trees, node, search);
}

void find_nearest(const BoxPairs& trees, DistanceSearch& search) {
    HWY_DYNAMIC_DISPATCH(nearest)(trees, search);
}

}  // namespace earshot::collision
#endif
