// SPDX-License-Identifier: MIT
#include "earshot/bvh/wide_tree.h"

#include "earshot/base/simd.h"
#include "earshot/bvh/internal/wide_node.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Mesh;

bool is_empty(const WideNode& node, std::size_t slot) {
    return node.planes[0][slot] > node.planes[1][slot];
}

/// Coordinate `run` (x, y, z of the first corner, then of the others) of triangle k of a leaf.
float coordinate(const WideTree& wide, std::uint32_t leaf, std::size_t run, std::size_t k) {
    const std::uint32_t* words = wide.packed_leaf(leaf);
    const std::size_t place = run * leaf_count(leaf) + k;
    if (wide.leaf_encoding() == LeafEncoding::single) {
        return std::bit_cast<float>(words[place]);
    }
    const std::uint32_t steps =
        words[kQuantisationFrameWords + place / 2] >> (place % 2 == 0 ? 0 : 16) & 0xFFFFU;
    return std::bit_cast<float>(words[run % 3]) +
           static_cast<float>(steps) * std::bit_cast<float>(words[3]);
}

/// How far a coordinate of a leaf may be from the mesh's.
double slack_of(const WideTree& wide, std::uint32_t leaf, double value) {
    const double rounding = 0x1p-24 * std::abs(value);
    return wide.leaf_encoding() == LeafEncoding::single
               ? rounding
               : 0.5 * std::bit_cast<float>(wide.packed_leaf(leaf)[3]) +
                     0x1p-22 * wide.max_abs_coordinate();
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
            const auto triangles = wide.leaf_triangles(child);
            for (std::size_t k = 0; k < count; ++k) {
                const std::uint32_t id = triangles[k];
                if (id >= seen.size() || seen[id]++ > 0) {
                    return "triangle missing or doubled";
                }
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    const auto& position = mesh.positions[mesh.triangles[id][corner]];
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        const double value = position[static_cast<int>(axis)];
                        const auto rounded = static_cast<float>(value);
                        const float held = coordinate(wide, child, 3 * corner + axis, k);
                        if (std::abs(held - value) > slack_of(wide, child, value) ||
                            !holds(axis, rounded, rounded)) {
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
        for (const int max_leaf_size : {1, 4, 8, 9, 15}) {
            const Tree tree =
                Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = max_leaf_size});
            for (const LeafEncoding form : {LeafEncoding::single, LeafEncoding::quantised}) {
                const WideTree wide = WideTree::build(tree, mesh.view(), Executor::serial(), form);
                EXPECT_EQ(fault_of(wide, mesh), "")
                    << count << " triangles, leaves of " << max_leaf_size;
                EXPECT_EQ(wide.triangle_count(), count);
            }
        }
    }
}

// Along the diagonal of every octant, the children stand from the farthest on, but for roundings.
TEST(WideTree, OrdersChildrenByOctant) {
    const Mesh mesh = test::triangle_soup(9, 5000);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const WideTree expected = WideTree::build(tree, mesh.view());
    for (const WideNode& node : expected.nodes()) {
        for (unsigned octant = 0; octant < 8; ++octant) {
            double previous = std::numeric_limits<double>::infinity();
            unsigned slots = 0;
            for (const std::uint32_t word : node.order) {
                const std::uint32_t slot = word >> (3 * octant) & 7U;
                slots |= 1U << slot;
                if (is_empty(node, slot)) {
                    continue;
                }
                double place = 0.0;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const double doubled_centre =
                        static_cast<double>(node.planes[2 * axis][slot]) +
                        static_cast<double>(node.planes[2 * axis + 1][slot]);
                    place += (octant >> axis & 1U) != 0 ? -doubled_centre : doubled_centre;
                }
                EXPECT_LE(place, previous + 1e-5 * expected.max_abs_coordinate());
                previous = place;
            }
            EXPECT_EQ(slots, 255U);
        }
    }
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        const WideTree wide = WideTree::build(tree, mesh.view());
        override_simd_target("auto");
        EXPECT_TRUE(
            std::ranges::equal(std::as_bytes(wide.nodes()), std::as_bytes(expected.nodes())))
            << target;
        EXPECT_TRUE(std::ranges::equal(wide.packed_leaves(), expected.packed_leaves())) << target;
    }
}

TEST(WideTree, HoldsTrianglesThatCoincide) {
    Mesh mesh = test::triangle_soup(3, 1);
    mesh.triangles.resize(1000, mesh.triangles.front());
    const Tree tree = Tree::build(triangle_boxes(mesh.view()), {.max_leaf_size = 15});
    EXPECT_EQ(fault_of(WideTree::build(tree, mesh.view()), mesh), "");
}

TEST(WideTree, IsTheSameForAnyNumberOfThreads) {
    const Mesh mesh = test::triangle_soup(5, 20000);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const auto bytes_of = [](const WideTree& wide) {
        const auto nodes = std::as_bytes(wide.nodes());
        const auto words = std::as_bytes(wide.packed_leaves());
        std::vector<std::byte> all(nodes.begin(), nodes.end());
        all.insert(all.end(), words.begin(), words.end());
        return all;
    };
    Executor eight(8);
    for (const LeafEncoding form : {LeafEncoding::single, LeafEncoding::quantised}) {
        WideTree first = WideTree::build(tree, mesh.view(), Executor::serial(), form);
        WideTree second = WideTree::build(tree, mesh.view(), eight, form);
        EXPECT_EQ(bytes_of(first), bytes_of(second));
        Mesh moved = mesh;
        for (auto& position : moved.positions) {
            position *= 1.5;
        }
        first.refit(moved.view());
        second.refit(moved.view(), eight);
        EXPECT_EQ(bytes_of(first), bytes_of(second));
        EXPECT_EQ(fault_of(second, moved), "");
    }
}

TEST(WideTree, FitsIntoFiftyBytesPerTriangleAndFortyIfQuantised) {
    const Mesh mesh = test::sphere(7, 1.0, geometry::Vec3(0.0));
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    const auto bytes_per_triangle = [&](LeafEncoding form) {
        const WideTree wide = WideTree::build(tree, mesh.view(), Executor::serial(), form);
        return static_cast<double>(wide.bytes()) / static_cast<double>(wide.triangle_count());
    };
    EXPECT_LE(bytes_per_triangle(LeafEncoding::single), 50.0);
    EXPECT_LE(bytes_per_triangle(LeafEncoding::quantised), 40.0);
}

}  // namespace
}  // namespace earshot::bvh
