// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_tree.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <bit>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Mesh;

bool is_empty(const WideNode& node, std::size_t slot) {
    return node.planes[0][slot] > node.planes[1][slot];
}

/// What is wrong with a wide tree; empty if nothing is: every triangle stands in one leaf with its
/// corners, every box holds what is below it, and every node but the root has one parent before it.
std::string fault_of(const WideTree& wide, const Mesh& mesh) {
    std::vector<int> seen(mesh.triangles.size(), 0);
    std::vector<int> parents(wide.nodes().size(), 0);
    for (std::size_t i = 0; i < wide.nodes().size(); ++i) {
        const WideNode& node = wide.nodes()[i];
        for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
            if (is_empty(node, slot)) {
                continue;
            }
            const std::uint32_t child = node.child[slot];
            const auto holds = [&](std::size_t axis, float low, float high) {
                return node.planes[2 * axis][slot] <= low &&
                       node.planes[2 * axis + 1][slot] >= high;
            };
            if (!is_leaf(child)) {
                if (child <= i || child >= wide.nodes().size()) {
                    return "child out of order";
                }
                ++parents[child];
                const WideNode& below = wide.nodes()[child];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    for (std::size_t k = 0; k < WideNode::kWidth; ++k) {
                        if (!is_empty(below, k) &&
                            !holds(
                                axis, below.planes[2 * axis][k], below.planes[2 * axis + 1][k])) {
                            return "child outside its parent";
                        }
                    }
                }
                continue;
            }
            const std::size_t count = leaf_count(child);
            const auto words = wide.words().subspan(WideTree::kWordsPerTriangle * leaf_first(child),
                                                    WideTree::kWordsPerTriangle * count);
            for (std::size_t k = 0; k < count; ++k) {
                const std::uint32_t id = words[9 * count + k];
                if (id >= seen.size() || seen[id]++ > 0) {
                    return "triangle missing or doubled";
                }
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    const auto& position = mesh.positions[mesh.triangles[id][corner]];
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        const auto value = static_cast<float>(position[static_cast<int>(axis)]);
                        const std::uint32_t word = words[(3 * corner + axis) * count + k];
                        if (std::bit_cast<float>(word) != value || !holds(axis, value, value)) {
                            return "corner wrong or outside its box";
                        }
                    }
                }
            }
        }
    }
    if (std::count(seen.begin(), seen.end(), 1) != static_cast<std::ptrdiff_t>(seen.size())) {
        return "triangle in no leaf";
    }
    const bool has_parents = std::all_of(
        parents.begin() + (parents.empty() ? 0 : 1), parents.end(), [](int n) { return n == 1; });
    return has_parents ? "" : "node without a parent, or with two";
}

TEST(WideTree, HoldsEveryTriangleOnceWhateverTheLeafSize) {
    for (const std::size_t count : {1U, 2U, 8U, 9U, 15U, 16U, 17U, 300U, 5000U}) {
        const Mesh mesh = test::triangle_soup(count, count);
        for (const int leaf_size : {1, 4, 8, 9, 15}) {
            const Tree tree = Tree::build(triangle_boxes(mesh.view()), {.leaf_size = leaf_size});
            const WideTree wide = WideTree::build(tree, mesh.view());
            EXPECT_EQ(fault_of(wide, mesh), "") << count << " triangles, leaves of " << leaf_size;
            EXPECT_EQ(wide.triangles(), count);
        }
    }
}

TEST(WideTree, HoldsTrianglesThatCoincide) {
    Mesh mesh = test::triangle_soup(3, 1);
    mesh.triangles.resize(1000, mesh.triangles.front());
    const Tree tree = Tree::build(triangle_boxes(mesh.view()), {.leaf_size = 15});
    EXPECT_EQ(fault_of(WideTree::build(tree, mesh.view()), mesh), "");
}

TEST(WideTree, IsTheSameForAnyNumberOfThreads) {
    Mesh mesh = test::triangle_soup(5, 20000);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const auto bytes_of = [](const WideTree& wide) {
        const auto nodes = std::as_bytes(wide.nodes());
        const auto words = std::as_bytes(wide.words());
        std::vector<std::byte> all(nodes.begin(), nodes.end());
        all.insert(all.end(), words.begin(), words.end());
        return all;
    };
    WideTree first = WideTree::build(tree, mesh.view());
    Executor eight(8);
    WideTree second = WideTree::build(tree, mesh.view(), eight);
    EXPECT_EQ(bytes_of(first), bytes_of(second));
    for (auto& position : mesh.positions) {
        position *= 1.5;
    }
    first.refit(mesh.view());
    second.refit(mesh.view(), eight);
    EXPECT_EQ(bytes_of(first), bytes_of(second));
    EXPECT_EQ(fault_of(second, mesh), "");
}

TEST(WideTree, FitsIntoSixtyBytesPerTriangle) {
    const Mesh mesh = test::sphere(7, 1.0, geometry::Vec3(0.0));
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const WideTree wide = WideTree::build(tree, mesh.view());
    EXPECT_LE(static_cast<double>(wide.bytes()), 60.0 * static_cast<double>(wide.triangles()));
}

}  // namespace
}  // namespace earshot::bvh
