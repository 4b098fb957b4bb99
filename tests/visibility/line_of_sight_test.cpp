// SPDX-License-Identifier: MIT
#include "earshot/visibility/line_of_sight.h"

#include "earshot/base/simd.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/visibility/coherent_line_of_sight.h"

#include <gtest/gtest.h>

#include "line_of_sight_scenes.h"

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::Segment;
using geometry::TriangleId;
using geometry::Vec3;
using support::Dice;

std::vector<Segment> some_segments(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
    Dice dice(seed);
    std::vector<Segment> segments(count);
    for (Segment& segment : segments) {
        segment = some_segment(mesh.view(), dice);
    }
    return segments;
}

std::optional<Blocker> first_by_brute_force(const Mesh& mesh,
                                            const Segment& segment,
                                            const ExclusionMask& excluded) {
    std::optional<Blocker> first;
    for (TriangleId id = 0; id < mesh.triangles.size(); ++id) {
        if (excluded.contains(id) || !blocks(mesh.view(), id, segment)) {
            continue;
        }
        const auto [a, b, c] = geometry::corners(mesh, id);
        const auto at = geometry::first_touch(segment, a, b, c);
        if (at && (!first || *at < first->t)) {
            first = {id, *at};
        }
    }
    return first;
}

/// Returns how many of the segments were free.
std::size_t compare(const std::string& scene, std::size_t count) {
    const Mesh mesh = scene_mesh(scene);
    const auto segments = some_segments(mesh, count, count);
    Executor two(2);
    const auto seen = visible({wide_tree_of(mesh.view()), mesh.view()}, segments, {}, two);
    std::size_t free = 0, different = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const bool expected =
            visible_by_brute_force(mesh.view(), segments[i], [](TriangleId) { return false; });
        free += expected ? 1 : 0;
        different += expected != (seen[i] != 0) ? 1 : 0;
    }
    EXPECT_EQ(different, 0U) << scene;
    return free;
}

TEST(LineOfSight, EqualsALoopOverAllTriangles) {
    for (const std::string& scene : kSceneNames) {
        const std::size_t count = scene == "concert_hall" ? 1000 : 5000;
        const std::size_t free = compare(scene, count);
        EXPECT_GT(free, count / 100);
        EXPECT_LT(free, count);
    }
}

TEST(SlowLineOfSight, EqualsALoopOverAllTrianglesAMillionTimes) {
    for (const std::string& scene : kSceneNames) {
        compare(scene, 200000);
    }
}

TEST(LineOfSight, IsTheSameOneByOneAndInBatches) {
    const Mesh mesh = scene_mesh("classroom");
    const auto tree = wide_tree_of(mesh.view());
    const auto segments = some_segments(mesh, 3000, 5);
    ExclusionMask excluded;
    for (TriangleId id = 0; id < mesh.triangles.size(); id += 3) {
        excluded.add(id);
    }
    for (const ExclusionMask& passed : {ExclusionMask(), excluded}) {
        const auto seen = visible({tree, mesh.view()}, segments, passed);
        const auto blockers = first_blockers({tree, mesh.view()}, segments, passed);
        for (std::size_t i = 0; i < segments.size(); ++i) {
            ASSERT_EQ(seen[i] != 0, visible({tree, mesh.view()}, segments[i], passed));
            ASSERT_EQ(blockers[i], first_blocker({tree, mesh.view()}, segments[i], passed));
            ASSERT_EQ(blockers[i], first_by_brute_force(mesh, segments[i], passed));
            ASSERT_EQ(seen[i] != 0, !blockers[i]);
        }
    }
}

TEST(LineOfSight, DoesNotDependOnBuilderThreadsInstructionsOrDirection) {
    const Mesh mesh = scene_mesh("coupled_rooms");
    auto segments = some_segments(mesh, 4000, 6);
    const auto expected = visible({wide_tree_of(mesh.view()), mesh.view()}, segments);
    Executor two(2), eight(8);
    for (const auto builder : {bvh::Builder::lbvh, bvh::Builder::spatial_median}) {
        const auto tree = wide_tree_of(mesh.view(), {.builder = builder});
        for (const std::string& target : simd_targets()) {
            override_simd_target(target);
            EXPECT_EQ(visible({tree, mesh.view()}, segments, {}, two), expected) << target;
            EXPECT_EQ(visible({tree, mesh.view()}, segments, {}, eight), expected) << target;
        }
        override_simd_target("auto");
    }
    for (Segment& segment : segments) {
        std::swap(segment.from, segment.to);
    }
    EXPECT_EQ(visible({wide_tree_of(mesh.view()), mesh.view()}, segments), expected);
}

TEST(LineOfSight, GrazingBlocks) {
    // Two triangles of a square at x = 0 that share the edge from (0,0,0) to (0,1,1).
    const Mesh square{{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
    const auto tree = wide_tree_of(square.view());
    const auto blocker = [&](const Segment& segment) {
        return first_blocker({tree, square.view()}, segment);
    };
    EXPECT_FALSE(blocker({{1, 0.5, 0.25}, {2, 0.5, 0.25}}));
    EXPECT_EQ(blocker({{-1, 0.75, 0.25}, {1, 0.75, 0.25}}), (Blocker{0, 0.5}));
    EXPECT_EQ(blocker({{-1, 0.5, 0.5}, {1, 0.5, 0.5}}), (Blocker{0, 0.5}));   // the shared edge
    EXPECT_EQ(blocker({{-1, 1, 0.5}, {1, 1, 0.5}}), (Blocker{0, 0.5}));       // a border
    EXPECT_EQ(blocker({{-1, 0, 1}, {1, 0, 1}}), (Blocker{1, 0.5}));           // a corner
    EXPECT_EQ(blocker({{-1, -1, 0.5}, {1, 1, 0.5}}), (Blocker{1, 0.5}));      // at its border
    EXPECT_EQ(blocker({{0, -1, 0.5}, {0, 3, 0.5}}), (Blocker{1, 0.25}));      // in its plane
    EXPECT_FALSE(blocker({{0, 1.5, 0.5}, {0, 3, 0.5}}));                      // beside it there
    EXPECT_EQ(blocker({{0, 0.5, 0.25}, {5, 0, 0}}), (Blocker{0, 0.0}));       // from its surface
    EXPECT_EQ(blocker({{5, 0, 0}, {0, 0.25, 0.75}}), (Blocker{1, 1.0}));      // to its surface
    EXPECT_EQ(blocker({{0, 0.25, 0.5}, {0, 0.25, 0.5}}), (Blocker{1, 0.0}));  // a point of it
    EXPECT_FALSE(blocker({{1, 0.25, 0.5}, {1, 0.25, 0.5}}));
}

TEST(LineOfSight, PassesExcludedTriangles) {
    const Mesh panes{{{1, -9, -9}, {1, 9, -9}, {1, 0, 9}, {2, -9, -9}, {2, 9, -9}, {2, 0, 9}},
                     {{0, 1, 2}, {3, 4, 5}}};
    const auto tree = wide_tree_of(panes.view());
    const Segment through{{0, 0, 0}, {4, 0, 0}};
    const std::vector<std::uint32_t> materials{7, 3};
    const auto excluding = [&](std::vector<std::uint32_t> which) {
        return ExclusionMask::of_materials(materials, which);
    };
    EXPECT_EQ(first_blocker({tree, panes.view()}, through, excluding({7})), (Blocker{1, 0.5}));
    EXPECT_EQ(first_blocker({tree, panes.view()}, through, excluding({3})), (Blocker{0, 0.25}));
    EXPECT_TRUE(visible({tree, panes.view()}, through, excluding({3, 7})));
    EXPECT_FALSE(visible({tree, panes.view()}, through, excluding({5})));
}

// The oracle is the mesh without the triangles of no area. Segments pass through their corners,
// along them and end on them.
TEST(LineOfSight, TrianglesWithoutAreaBlockNothing) {
    for (const char* scene : {"shoebox", "classroom", "lroom"}) {
        const Mesh with_area = scene_mesh(scene);
        Mesh mesh = with_area;
        Dice dice(21);
        std::vector<Segment> segments;
        for (int i = 0; i < 300; ++i) {
            const Segment line = some_segment(with_area.view(), dice);
            const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
            const Vec3 step(dice.below(3) - 1, dice.below(3) - 1, dice.below(3) - 1);
            // On a grid of 1/64 m sums are exact, so that three corners are on a line.
            const Vec3 from = glm::round(64.0 * line.from) / 64.0;
            mesh.positions.insert(mesh.positions.end(), {from, from + step, from + 2.0 * step});
            switch (i % 3) {
                case 0:
                    mesh.triangles.push_back({first, first + 1, first + 2});
                    break;
                case 1:
                    mesh.triangles.push_back({first, first + 2, first});
                    break;
                default:
                    mesh.triangles.push_back({first + 1, first + 1, first + 1});
            }
            segments.push_back({from, line.to});
            segments.push_back({from - step, from + 3.0 * step});
            segments.push_back({line.to, from + step});
            segments.push_back(line);
        }
        const auto tree = wide_tree_of(mesh.view());
        const auto visible_pairs = visible({tree, mesh.view()}, segments);
        const auto blockers = first_blockers({tree, mesh.view()}, segments);
        CoherentLineOfSight coherent(mesh.view());
        EXPECT_EQ(coherent.visible(mesh.view(), segments), visible_pairs);
        std::size_t free = 0;
        for (std::size_t i = 0; i < segments.size(); ++i) {
            const bool expected = visible_by_brute_force(
                with_area.view(), segments[i], [](TriangleId) { return false; });
            free += expected ? 1 : 0;
            ASSERT_EQ(visible_pairs[i] != 0, expected) << scene << i;
            ASSERT_EQ(!blockers[i], expected) << scene << i;
            ASSERT_EQ(!bvh::brute_force::occluded(mesh.view(), segments[i]), expected);
            if (blockers[i]) {
                ASSERT_LT(blockers[i]->triangle, with_area.triangles.size());
            }
        }
        EXPECT_GT(free, 50U);
    }
}

TEST(LineOfSight, IsVisibleInAnEmptyMesh) {
    const bvh::WideTree nothing = wide_tree_of({});
    EXPECT_TRUE(visible({nothing, {}}, Segment{{0, 0, 0}, {1, 1, 1}}));
    EXPECT_TRUE(visible({nothing, {}}, std::span<const Segment>{}).empty());
}

}  // namespace
}  // namespace earshot::visibility
