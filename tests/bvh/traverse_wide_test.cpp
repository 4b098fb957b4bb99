// SPDX-License-Identifier: MIT
#include "earshot/bvh/traverse_wide.h"

#include "earshot/geometry/intersect.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <optional>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Aabb;
using geometry::Mesh;
using geometry::Segment;
using geometry::TriangleId;

WideTree wide_tree_of(const Mesh& mesh) {
    return WideTree::build(Tree::build(triangle_boxes(mesh.view())), mesh.view());
}

Segment segment_of(std::uint64_t seed, std::uint64_t i) {
    return {2.0 * test::random_point(seed, 2 * i), 2.0 * test::random_point(seed, 2 * i + 1)};
}

std::optional<double> first_touch(const Mesh& mesh, const Segment& segment, TriangleId id) {
    const geometry::Triangle& triangle = mesh.triangles[id];
    return geometry::first_touch(segment,
                                 mesh.positions[triangle[0]],
                                 mesh.positions[triangle[1]],
                                 mesh.positions[triangle[2]]);
}

/// The triangles that a segment touches, by testing all of them.
std::vector<TriangleId> touched(const Mesh& mesh, const Segment& segment) {
    std::vector<TriangleId> found;
    for (TriangleId id = 0; id < mesh.triangles.size(); ++id) {
        if (first_touch(mesh, segment, id)) {
            found.push_back(id);
        }
    }
    return found;
}

TEST(TraverseWide, VisitsEveryTriangleOnceWhereEverythingOverlaps) {
    const Mesh mesh = test::triangle_soup(1, 700);
    std::vector<int> visits(mesh.triangles.size(), 0);
    traverse(
        wide_tree_of(mesh),
        [](const Aabb&) { return true; },
        [&](TriangleId id) {
            ++visits[id];
            return true;
        });
    EXPECT_EQ(visits, std::vector<int>(mesh.triangles.size(), 1));
}

TEST(TraverseWide, StopsWhenToldTo) {
    const Mesh mesh = test::triangle_soup(2, 300);
    const WideTree tree = wide_tree_of(mesh);
    int visits = 0;
    const auto third = [&](TriangleId) { return ++visits < 3; };
    traverse(
        tree, [](const Aabb&) { return true; }, third);
    EXPECT_EQ(visits, 3);
    visits = 0;
    for (std::uint64_t i = 0; i < 50; ++i) {
        const int before = visits;
        traverse_front_to_back(tree, segment_of(2, i), 1.0, every_slot, [&](TriangleId) {
            ++visits;
            return false;
        });
        EXPECT_LE(visits, before + 1);
    }
    EXPECT_GT(visits, 0);
}

TEST(TraverseWide, OffersASegmentAllTrianglesThatItTouches) {
    const Mesh mesh = test::triangle_soup(3, 500);
    const WideTree tree = wide_tree_of(mesh);
    std::size_t count = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
        const Segment segment = segment_of(3, i);
        std::vector<TriangleId> found;
        traverse_front_to_back(tree, segment, 1.0, every_slot, [&](TriangleId id) {
            if (first_touch(mesh, segment, id)) {
                found.push_back(id);
            }
            return true;
        });
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found, touched(mesh, segment)) << i;
        count += found.size();
    }
    EXPECT_GT(count, 100U);
}

// Lowering t_max saves visits of nodes and never loses the first touch.
TEST(TraverseWide, SkipsWhatBeginsBeyondALoweredEnd) {
    const Mesh mesh = test::triangle_soup(4, 2000);
    const WideTree tree = wide_tree_of(mesh);
    std::size_t all_nodes = 0, nodes = 0;
    for (std::uint64_t i = 0; i < 100; ++i) {
        const Segment segment = segment_of(4, i);
        std::optional<double> expected;
        for (const TriangleId id : touched(mesh, segment)) {
            const double t = *first_touch(mesh, segment, id);
            expected = expected ? std::min(*expected, t) : t;
        }
        std::optional<double> first;
        double t_max = 1.0;
        nodes += traverse_front_to_back(tree, segment, t_max, every_slot, [&](TriangleId id) {
            const auto t = first_touch(mesh, segment, id);
            if (t && (!first || *t < *first)) {
                first = t;
                t_max = std::min(1.0, *t + 0x1p-36);
            }
            return true;
        });
        all_nodes +=
            traverse_front_to_back(tree, segment, 1.0, every_slot, [](TriangleId) { return true; });
        ASSERT_EQ(first, expected) << i;
    }
    EXPECT_LT(nodes, all_nodes);
}

TEST(TraverseWide, SkipsFilteredSlots) {
    const Mesh mesh = test::triangle_soup(5, 200);
    const auto none = [](std::uint32_t, std::size_t) { return false; };
    const std::size_t nodes = traverse_front_to_back(
        wide_tree_of(mesh), segment_of(5, 0), 1.0, none, [](TriangleId) -> bool {
            ADD_FAILURE() << "a filtered slot was visited";
            return true;
        });
    EXPECT_EQ(nodes, 1U);
}

TEST(TraverseWide, AnEmptyTreeHasNothingToVisit) {
    const auto fail = [](TriangleId) -> bool {
        ADD_FAILURE() << "a triangle of an empty tree was visited";
        return true;
    };
    traverse(
        WideTree(), [](const Aabb&) { return true; }, fail);
    EXPECT_EQ(traverse_front_to_back(WideTree(), segment_of(6, 0), 1.0, every_slot, fail), 0U);
}

}  // namespace
}  // namespace earshot::bvh
