// SPDX-License-Identifier: MIT
#include "earshot/bvh/partial_refit.h"

#include "earshot/base/assert.h"
#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>

namespace earshot::bvh {
namespace {

enum DirtyFlag : std::uint8_t { kChildMoved = 1, kLeafMoved = 2 };

}  // namespace

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
    // Parents come before their children.
    for (std::uint32_t i = last + 1; i-- > 0;) {
        const std::uint8_t flags = dirty_[i];
        if (flags == 0) {
            continue;
        }
        dirty_[i] = 0;
        dirty_[parents_[i]] |= i > 0 ? kChildMoved : 0;
        tree.refit_node(i, mesh, (flags & kLeafMoved) != 0);
    }
    tree.set_box();
}

}  // namespace earshot::bvh
