// SPDX-License-Identifier: MIT
#include "earshot/visibility/exclusion_mask.h"

#include "earshot/visibility/free_segments.h"
#include "earshot/visibility/global_sampling.h"
#include "earshot/visibility/guided_sampling.h"
#include "earshot/visibility/internal/masked_hits.h"
#include "earshot/visibility/item_buffer.h"
#include "earshot/visibility/line_of_sight.h"
#include "earshot/visibility/pvs_validation.h"
#include "earshot/visibility/sample_free_segments.h"
#include "earshot/visibility/visible_triangles.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/dice.h"
#include "support/meshes.h"
#include "visibility/screens.h"
#include <algorithm>
#include <string>

namespace earshot::visibility {
namespace {

using geometry::Hit;
using geometry::Mesh;
using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;
using test::tree_of;

/// A mesh, a mask of it, and the oracle: a mesh that lacks the excluded triangles.
struct Case {
    std::string name;
    Mesh mesh;
    ExclusionMask excluded{};
    Mesh remaining{};
    std::vector<TriangleId> ids{};  // of the remaining triangles in the whole mesh

    template <typename IsExcluded>
    Case(std::string case_name, Mesh whole, IsExcluded&& is_excluded)
        : name(std::move(case_name)), mesh(std::move(whole)) {
        remaining.positions = mesh.positions;
        for (TriangleId id = 0; id < mesh.triangles.size(); ++id) {
            if (is_excluded(id)) {
                excluded.add(id);
            } else {
                remaining.triangles.push_back(mesh.triangles[id]);
                ids.push_back(id);
            }
        }
    }

    TriangleId in_mesh(TriangleId id) const { return id == kNoTriangle ? id : ids[id]; }
};

/// A room behind panes, a soup of which a third is excluded, a sphere in a sphere.
std::vector<Case> cases() {
    std::vector<Case> result;
    Mesh room = test::cube(4, 6.0);
    const auto walls = static_cast<TriangleId>(room.triangles.size());
    test::add_screen(room, {-2.0, -2.0, -1.0}, {2.0, 2.0, -1.0}, 3, 3);
    test::add_screen(room, {-2.0, -2.0, -1.5}, {2.0, 2.0, -1.5}, 2, 5);
    result.emplace_back("panes", std::move(room), [=](TriangleId id) { return id >= walls; });
    result.emplace_back(
        "soup", test::triangle_soup(8, 900), [](TriangleId id) { return id % 3 == 1; });
    Mesh shells = test::sphere(3, 1.0, {0.0, 0.0, 0.0});
    const auto inner = static_cast<TriangleId>(shells.triangles.size());
    const Mesh outer = test::sphere(3, 2.0, {0.0, 0.0, 0.0});
    const auto first = static_cast<geometry::VertexId>(shells.positions.size());
    shells.positions.insert(shells.positions.end(), outer.positions.begin(), outer.positions.end());
    for (const geometry::Triangle& t : outer.triangles) {
        shells.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    result.emplace_back("shells", std::move(shells), [=](TriangleId id) { return id < inner; });
    return result;
}

std::vector<Ray> some_rays(std::size_t count) {
    support::Dice dice(count);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = dice.between(-0.5, 0.5);
            ray.direction[k] = dice.between(-1.0, 1.0);
        }
    }
    return rays;
}

TEST(ExclusionMask, RaysPassExcludedTrianglesToTheLastBit) {
    for (const Case& c : cases()) {
        const auto rays = some_rays(20'000);
        std::vector<std::optional<Hit>> masked(rays.size());
        Executor two(2);
        ASSERT_TRUE(closest_hits({tree_of(c.mesh), c.mesh.view()}, rays, c.excluded, masked, two));
        std::vector<std::optional<Hit>> expected(rays.size());
        closest_hits({tree_of(c.remaining), c.remaining.view()}, rays, {}, expected, two);
        std::size_t hits = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(masked[i].has_value(), expected[i].has_value()) << c.name << i;
            if (masked[i]) {
                expected[i]->triangle = c.in_mesh(expected[i]->triangle);
                ASSERT_EQ(*masked[i], *expected[i]) << c.name << i;
                ++hits;
            }
        }
        EXPECT_GT(hits, rays.size() / 4) << c.name;
    }
}

TEST(ExclusionMask, VisibleTrianglesAreThoseOfAMeshWithoutThem) {
    for (const Case& c : cases()) {
        VisibleTrianglesOptions options = {.resolution = 0.05};
        auto expected =
            visible_triangles({tree_of(c.remaining), c.remaining.view()}, Vec3(0.1), options);
        for (VisibleTriangle& entry : expected.triangles) {
            entry.triangle = c.in_mesh(entry.triangle);
        }
        options.excluded = c.excluded;
        EXPECT_EQ(visible_triangles({tree_of(c.mesh), c.mesh.view()}, Vec3(0.1), options), expected)
            << c.name;
    }
}

TEST(ExclusionMask, ItemBuffersAreThoseOfAMeshWithoutThem) {
    for (const Case& c : cases()) {
        const View view = {.width = 64, .height = 32};
        auto expected =
            render_item_buffer({tree_of(c.remaining), c.remaining.view()}, Vec3(0.1), view);
        for (TriangleId& triangle : expected.triangles) {
            triangle = c.in_mesh(triangle);
        }
        const ItemBuffer masked =
            render_item_buffer({tree_of(c.mesh), c.mesh.view()}, Vec3(0.1), view, c.excluded);
        EXPECT_EQ(masked.triangles, expected.triangles) << c.name;
        EXPECT_EQ(masked.distances, expected.distances) << c.name;
    }
}

TEST(ExclusionMask, FreeSegmentsPassExcludedTriangles) {
    for (const Case& c : cases()) {
        const ViewRegion region = {Vec3(-0.4), Vec3(0.4)};
        const auto expected = sample_free_segments(
            {tree_of(c.remaining), c.remaining.view()}, region, {.count = 3000});
        const auto masked = sample_free_segments(
            {tree_of(c.mesh), c.mesh.view()}, region, {.count = 3000, .excluded = c.excluded});
        ASSERT_EQ(masked.size(), expected.size()) << c.name;
        for (std::size_t i = 0; i < masked.size(); ++i) {
            ASSERT_EQ(masked[i].at_from, c.in_mesh(expected[i].at_from));
            ASSERT_EQ(masked[i].at_to, c.in_mesh(expected[i].at_to));
        }
    }
}

/// Whether the set holds only triangles that the mask lets through, and all of `known`.
void expect_masked(const Case& c,
                   const std::vector<TriangleId>& set,
                   const std::vector<TriangleId>& unmasked) {
    std::size_t excluded = 0;
    for (const TriangleId triangle : set) {
        excluded += c.excluded.contains(triangle) ? 1 : 0;
    }
    EXPECT_EQ(excluded, 0U) << c.name;
    // Without the mask some of them are in the set.
    EXPECT_TRUE(std::any_of(unmasked.begin(), unmasked.end(), [&](TriangleId id) {
        return c.excluded.contains(id);
    })) << c.name;
}

TEST(ExclusionMask, RegionsSeeThroughExcludedTriangles) {
    for (const Case& c : cases()) {
        const ViewRegion region = {Vec3(-0.3), Vec3(0.3)};
        const auto tree = tree_of(c.mesh);
        GuidedSamplingOptions options = {.max_rays = 60'000};
        const RegionPvs unmasked = sample_region({tree, c.mesh.view()}, region, options);
        options.excluded = c.excluded;
        const RegionPvs masked = sample_region({tree, c.mesh.view()}, region, options);
        expect_masked(c, masked.triangles, unmasked.triangles);
        // The oracle: what fresh rays hit first in a mesh without the excluded triangles.
        const MissedShare missed =
            validate_pvs({tree, c.mesh.view()},
                         Objects::triangles(c.mesh.triangles.size()),
                         ViewCells(region),
                         std::vector<std::vector<ObjectId>>{masked.triangles},
                         {.rays = 20'000, .excluded = c.excluded});
        EXPECT_LT(missed.estimate(), 0.01) << c.name;
        if (c.name != "soup") {
            EXPECT_EQ(masked.triangles, c.ids) << c.name;  // all of a convex room or shell
        }
    }
}

TEST(ExclusionMask, CellsSeeThroughExcludedTriangles) {
    for (const Case& c : cases()) {
        const ViewCells cells = ViewCells::grid({Vec3(-0.3), Vec3(0.3)}, {2, 1, 2});
        const Objects objects = Objects::triangles(c.mesh.triangles.size());
        GlobalSamplingOptions options = {.max_rays = 200'000, .samples_per_batch = 10'000};
        const auto tree = tree_of(c.mesh);
        const auto unmasked = sample_cells({tree, c.mesh.view()}, objects, cells, options).visible;
        options.excluded = c.excluded;
        const auto masked = sample_cells({tree, c.mesh.view()}, objects, cells, options).visible;
        for (std::size_t cell = 0; cell < cells.size(); ++cell) {
            expect_masked(c, masked[cell], unmasked[cell]);
        }
    }
}

TEST(ExclusionMask, HoldsTheTrianglesOfMaterials) {
    const std::vector<std::uint32_t> material_of_triangle = {0, 2, 1, 2, 0, 3};
    const std::vector<std::uint32_t> materials = {2, 3};
    const auto mask = ExclusionMask::of_materials(material_of_triangle, materials);
    for (TriangleId id = 0; id < 6; ++id) {
        EXPECT_EQ(mask.contains(id), id == 1 || id == 3 || id == 5);
    }
    EXPECT_FALSE(mask.contains(1000));
}

// Without an area: two corners equal, all equal, or three on a line, on and off the axes.
TEST(ExclusionMask, ExcludesTrianglesWithoutArea) {
    Mesh mesh;
    mesh.positions = {{0.0, 0.0, 0.0},
                      {1.0, 2.0, 3.0},
                      {0.5, 1.0, 1.5},
                      {3.0, 6.0, 9.0},
                      {1.0, 2.0, 3.0},
                      {1.0, 2.0, 3.0000000000000004}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 4}, {1, 4, 1}, {0, 1, 3}, {0, 1, 5}, {0, 3, 5}, {2, 3, 1}};
    const ExclusionMask mask = with_degenerate({}, mesh.view());
    for (const TriangleId id : {0U, 1U, 2U, 3U, 6U}) {
        EXPECT_TRUE(mask.contains(id)) << id;
    }
    // Half an ulp off the line is an area.
    EXPECT_FALSE(mask.contains(4));
    EXPECT_FALSE(mask.contains(5));
}

}  // namespace
}  // namespace earshot::visibility
