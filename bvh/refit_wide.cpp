// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/bvh/internal/coordinate_rules.h"
#include "earshot/bvh/internal/wide_node.h"

#include <vector>

namespace earshot::bvh {
namespace {

/// A subtree: the nodes [begin, end), in depth-first order, the root first.
struct SubtreeRange {
    std::size_t begin = 0, end = 0;
};

/// Subtrees for a task each, and the nodes above them.
struct Decomposition {
    std::vector<std::size_t> top;
    std::vector<SubtreeRange> subtrees;
};

Decomposition decompose(std::span<const WideNode> nodes) {
    constexpr std::size_t kMaxSubtreeSize = 512;
    Decomposition result;
    std::vector<SubtreeRange> stack = {{0, nodes.size()}};
    while (!stack.empty()) {
        const SubtreeRange range = stack.back();
        stack.pop_back();
        if (range.end - range.begin <= kMaxSubtreeSize) {
            result.subtrees.push_back(range);
            continue;
        }
        result.top.push_back(range.begin);
        std::size_t end = range.end;
        for (std::size_t slot = WideNode::kWidth; slot-- > 0;) {
            const std::uint32_t child = nodes[range.begin].child[slot];
            if (!is_leaf(child) && child != kNoChild) {
                stack.push_back({child, end});
                end = child;
            }
        }
    }
    return result;
}

}  // namespace

void WideTree::refit_node(std::size_t index,
                          const geometry::MeshView& mesh,
                          bool with_leaves,
                          CoordinateRules& rules) {
    WideNode& node = nodes_[index];
    for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
        const std::uint32_t child = node.child[slot];
        if (is_leaf(child)) {
            if (with_leaves) {
                set_slot_box(
                    node,
                    slot,
                    pack_leaf(leaf_encoding_, packed_leaf(child), leaf_count(child), mesh));
                rules.check(leaf_triangles(child), mesh);
            }
        } else if (child != kNoChild) {
            set_slot_box(node, slot, box_of(nodes_[child]));
        }
    }
}

void WideTree::refit(const geometry::MeshView& mesh, Executor& executor) {
    EARSHOT_ASSERT(mesh.triangles.size() == triangle_count_);
    if (nodes_.empty()) {
        return;
    }
    const auto for_each_leaf = [&](const WideNode& node, auto&& visit) {
        for (const std::uint32_t child : node.child) {
            if (is_leaf(child)) {
                visit(leaf_triangles(child));
            }
        }
    };
    // Triangles and vertices are prefetched some nodes before they are read.
    constexpr std::size_t kDistance = 2;
    const auto prefetch_for = [&](const SubtreeRange& range, std::size_t index) {
        if (index >= range.begin + 2 * kDistance) {
            for_each_leaf(nodes_[index - 2 * kDistance],
                          [&](std::span<const std::uint32_t> triangles) {
                              prefetch_triangles(triangles, mesh);
                          });
        }
        if (index >= range.begin + kDistance) {
            for_each_leaf(nodes_[index - kDistance], [&](std::span<const std::uint32_t> triangles) {
                prefetch_vertices(triangles, mesh);
            });
        }
    };
    // Children come after their parents, so running backwards is bottom-up.
    const Decomposition parts = decompose(nodes_);
    CoordinateRules unchecked = CoordinateRules(ExactCoordinates());
    executor.for_each(parts.subtrees.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const SubtreeRange& range = parts.subtrees[i];
            for (std::size_t node = range.end; node-- > range.begin;) {
                prefetch_for(range, node);
                refit_node(node, mesh, true, unchecked);
            }
        }
    });
    for (std::size_t i = parts.top.size(); i-- > 0;) {
        refit_node(parts.top[i], mesh, true, unchecked);
    }
    set_box(box_of(nodes_.front()));
    if (leaf_encoding_ == LeafEncoding::single) {
        CoordinateRules rules(max_abs_coordinate());
        rules.check(mesh.positions, executor);
        exact_coordinates_ = rules.result();
    }
}

}  // namespace earshot::bvh
