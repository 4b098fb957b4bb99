// SPDX-License-Identifier: MIT
#include "earshot/bvh/partial_refit.h"

#include "earshot/base/assert.h"
#include "earshot/bvh/internal/coordinate_rules.h"
#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>

namespace earshot::bvh {
namespace {

enum DirtyFlag : std::uint8_t { kChildMoved = 1, kLeafMoved = 2 };

}  // namespace

std::vector<std::uint8_t> moved_flags(const geometry::MeshView& mesh,
                                      std::span<const geometry::Vec3> before,
                                      Executor& executor) {
    const std::span<const geometry::Vec3> now = mesh.positions;
    const std::span<const geometry::Triangle> triangles = mesh.triangles;
    EARSHOT_ASSERT(before.size() == now.size());
    constexpr std::size_t kGrain = 16384;
    std::vector<std::uint8_t> has_moved(now.size()), flags(triangles.size());
    executor.for_each(now.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            has_moved[i] = before[i] != now[i] ? 1 : 0;
        }
    });
    executor.for_each(triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto& [a, b, c] = triangles[i];
            flags[i] = static_cast<std::uint8_t>(has_moved[a] | has_moved[b] | has_moved[c]);
        }
    });
    return flags;
}

std::vector<TriangleRange> ranges_of(std::span<const std::uint8_t> flags) {
    std::vector<TriangleRange> ranges;
    for (auto at = flags.begin();;) {
        const auto begin = std::find_if(at, flags.end(), [](auto flag) { return flag != 0; });
        if (begin == flags.end()) {
            return ranges;
        }
        at = std::find(begin, flags.end(), 0);
        ranges.push_back({static_cast<std::uint32_t>(begin - flags.begin()),
                          static_cast<std::uint32_t>(at - flags.begin())});
    }
}

PartialRefit::PartialRefit(const WideTree& tree)
    : node_of_triangle_(tree.triangle_count()),
      parents_(tree.nodes().size()),
      dirty_(tree.nodes().size()) {
    for (std::uint32_t i = 0; i < tree.nodes().size(); ++i) {
        for (const std::uint32_t child : tree.nodes()[i].child) {
            if (!is_leaf(child)) {
                parents_[child] = child == kNoChild ? 0 : i;
                continue;
            }
            for (const std::uint32_t id : tree.leaf_triangles(child)) {
                node_of_triangle_[id] = i;
            }
        }
    }
}

void PartialRefit::refit(WideTree& tree,
                         const geometry::MeshView& mesh,
                         std::span<const TriangleRange> moved) {
    EARSHOT_ASSERT(tree.triangle_count() == node_of_triangle_.size() &&
                   tree.nodes().size() == dirty_.size());
    std::uint32_t last = 0;
    bool has_moved = false;
    for (const TriangleRange& range : moved) {
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            dirty_[node_of_triangle_[i]] = kLeafMoved;
            last = std::max(last, node_of_triangle_[i]);
            has_moved = true;
        }
    }
    if (!has_moved) {
        return;
    }
    // Leaves that have not moved keep the rule that held for all.
    CoordinateRules rules(tree.exact_coordinates_);
    // Parents come before their children.
    for (std::uint32_t i = last + 1; i-- > 0;) {
        const std::uint8_t flags = dirty_[i];
        if (flags == 0) {
            continue;
        }
        dirty_[i] = 0;
        dirty_[parents_[i]] |= i > 0 ? kChildMoved : 0;
        tree.refit_node(i, mesh, (flags & kLeafMoved) != 0, rules);
    }
    tree.exact_coordinates_ = rules.result();
    tree.set_box(box_of(tree.nodes_.front()));
}

}  // namespace earshot::bvh
