// SPDX-License-Identifier: MIT
#include "earshot/visibility/visible_sets.h"

#include "earshot/base/error.h"
#include "earshot/visibility/merge_cells.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace earshot::visibility {
namespace {

using geometry::TriangleId;
using geometry::Vec3;
using Sets = std::vector<std::vector<ObjectId>>;

const ViewRegion kRegion = {{0.0, 0.0, 0.0}, {4.0, 1.0, 1.0}};

/// Four cells in a row that see objects {0, 1}, {0, 1}, {1, 2}, {2}; object 1 has two triangles.
VisibleSets four_cells() {
    const ViewCells cells = ViewCells::grid(kRegion, {4, 1, 1});
    const Sets sets = {{0, 1}, {0, 1}, {1, 2}, {2}};
    return {cells,
            Objects(std::vector<ObjectId>{1, 0, 1, 2}),
            sets,
            {.scene = "row"},
            merge_cells(cells, sets, std::vector<double>{1.0, 1.0, 1.0})};
}

TEST(VisibleSets, LeadFromAPointToItsTriangles) {
    const VisibleSets sets = four_cells();
    const auto cell = sets.cells().cell_at({2.5, 0.5, 0.5});
    ASSERT_TRUE(cell);
    EXPECT_EQ(sets.triangles_visible_from(*cell), (std::vector<TriangleId>{0, 2, 3}));
    EXPECT_TRUE(sets.contains(*cell, 2));
    EXPECT_FALSE(sets.contains(*cell, 1));
    EXPECT_EQ(sets.entries(), 7U);
}

TEST(VisibleSets, MergeByTheirHistory) {
    const VisibleSets merged = four_cells().merged(2);
    ASSERT_EQ(merged.cells().size(), 2U);
    const auto left = merged.cells().cell_at({1.5, 0.5, 0.5});
    const auto right = merged.cells().cell_at({2.5, 0.5, 0.5});
    ASSERT_TRUE(left && right);
    EXPECT_EQ(merged.sets()[*left], (std::vector<ObjectId>{0, 1}));
    EXPECT_EQ(merged.sets()[*right], (std::vector<ObjectId>{1, 2}));
    EXPECT_DOUBLE_EQ(merged.cells().volumes()[*left], 2.0);
    EXPECT_THROW(merged.merged(1), Error);
}

TEST(VisibleSets, RefuseInconsistentParts) {
    const Objects objects = Objects::triangles(3);
    const ViewCells cells = ViewCells::grid(kRegion, {2, 1, 1});
    EXPECT_NO_THROW(VisibleSets(cells, objects, Sets{{0, 2}, {}}, {}));
    EXPECT_THROW(VisibleSets(cells, objects, Sets{{0}}, {}), Error);
    EXPECT_THROW(VisibleSets(cells, objects, Sets{{0, 3}, {}}, {}), Error);
    EXPECT_THROW(VisibleSets(cells, objects, Sets{{2, 0}, {}}, {}), Error);
    EXPECT_THROW(VisibleSets(cells, objects, Sets{{1, 1}, {}}, {}), Error);
    EXPECT_THROW(VisibleSets(cells, objects, Sets{{0}, {}}, {}, four_cells().history()), Error);
}

TEST(VisibleSets, TellPosesApart) {
    geometry::Mesh mesh = test::cube(2, 1.0);
    const std::uint64_t digest = mesh_digest(mesh.view());
    EXPECT_EQ(mesh_digest(test::cube(2, 1.0).view()), digest);
    mesh.positions.back().x += 1e-9;
    EXPECT_NE(mesh_digest(mesh.view()), digest);
}

}  // namespace
}  // namespace earshot::visibility
