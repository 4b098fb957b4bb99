// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/bvh/internal/wide_node.h"

#include <vector>

namespace earshot::bvh {
namespace {

/// Nodes from a root on that stand in one run, in depth-first order.
struct Run {
    std::size_t begin = 0, end = 0;
};

/// The nodes above the runs, and the runs.
struct Cut {
    std::vector<std::size_t> top;
    std::vector<Run> runs;
};

Cut cut(std::span<const WideNode> nodes) {
    constexpr std::size_t kRunSize = 512;
    Cut result;
    std::vector<Run> open = {{0, nodes.size()}};
    while (!open.empty()) {
        const Run run = open.back();
        open.pop_back();
        if (run.end - run.begin <= kRunSize) {
            result.runs.push_back(run);
            continue;
        }
        result.top.push_back(run.begin);
        std::size_t end = run.end;
        for (std::size_t slot = WideNode::kWidth; slot-- > 0;) {
            const std::uint32_t child = nodes[run.begin].child[slot];
            if (!is_leaf(child) && child != kNoChild) {
                open.push_back({child, end});
                end = child;
            }
        }
    }
    return result;
}

}  // namespace

void WideTree::refit_node(std::size_t index, const geometry::MeshView& mesh, bool with_leaves) {
    WideNode& node = nodes_[index];
    for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
        const std::uint32_t child = node.child[slot];
        if (is_leaf(child)) {
            if (with_leaves) {
                set_slot_box(
                    node,
                    slot,
                    fill_leaf(leaf_encoding_, packed_leaf(child), leaf_count(child), mesh));
            }
        } else if (child != kNoChild) {
            set_slot_box(node, slot, box_of(nodes_[child]));
        }
    }
}

void WideTree::set_box() {
    box_ = box_of(nodes_.front());
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
    // What a node will read of the mesh is asked for some nodes before.
    constexpr std::size_t kAhead = 2;
    const auto fetch_for = [&](const Run& run, std::size_t index) {
        if (index >= run.begin + 2 * kAhead) {
            for_each_leaf(nodes_[index - 2 * kAhead],
                          [&](std::span<const std::uint32_t> triangles) {
                              fetch_triangles(triangles, mesh);
                          });
        }
        if (index >= run.begin + kAhead) {
            for_each_leaf(nodes_[index - kAhead], [&](std::span<const std::uint32_t> triangles) {
                fetch_corners(triangles, mesh);
            });
        }
    };
    // Children stand behind their parents, so running backwards is bottom-up.
    const Cut parts = cut(nodes_);
    executor.for_each(parts.runs.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Run& run = parts.runs[i];
            for (std::size_t node = run.end; node-- > run.begin;) {
                fetch_for(run, node);
                refit_node(node, mesh, true);
            }
        }
    });
    for (std::size_t i = parts.top.size(); i-- > 0;) {
        refit_node(parts.top[i], mesh, true);
    }
    set_box();
}

}  // namespace earshot::bvh
