// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/cell_adjacency.h"

#include "earshot/visibility/cell_shape.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "visibility/random_cells.h"
#include <map>

namespace earshot::visibility {
namespace {

using geometry::Vec3;

TEST(CellAdjacency, OfAGridAreItsNeighbours) {
    // Boxes of 1 x 2 x 3.
    const auto contacts =
        cell_adjacencies(ViewCells::grid({Vec3(0.0), {3.0, 4.0, 6.0}}, {3, 2, 2}));
    std::map<std::pair<LeafId, LeafId>, double> expected;
    for (LeafId i = 0; i < 12; ++i) {
        if (i % 3 < 2) {
            expected[{i, i + 1}] = 6.0;
        }
        if (i / 3 % 2 < 1) {
            expected[{i, i + 3}] = 3.0;
        }
        if (i / 6 < 1) {
            expected[{i, i + 6}] = 2.0;
        }
    }
    ASSERT_EQ(contacts.size(), expected.size());
    auto next = expected.begin();
    for (const CellAdjacency& contact : contacts) {
        EXPECT_EQ(std::pair(contact.first, contact.second), next->first);
        EXPECT_NEAR(contact.area, next->second, 1e-12);
        ++next;
    }
}

TEST(CellAdjacency, CoverTheSurfaceOfEveryLeafButForTheBorder) {
    const ViewCells cells = test::random_cells(3, 300);
    const auto shapes = leaf_shapes(cells);
    std::vector<double> touched(cells.leaves(), 0.0);
    for (const CellAdjacency& contact : cell_adjacencies(cells)) {
        EXPECT_LT(contact.first, contact.second);
        touched[contact.first] += contact.area;
        touched[contact.second] += contact.area;
    }
    for (std::size_t leaf = 0; leaf < shapes.size(); ++leaf) {
        double surface = 0.0;
        for (const CellFace& face : shapes[leaf].faces()) {
            Vec3 twice_area(0.0);
            const auto corners = shapes[leaf].corners();
            for (std::size_t i = 2; i < face.corners.size(); ++i) {
                twice_area += glm::cross(corners[face.corners[i - 1]] - corners[face.corners[0]],
                                         corners[face.corners[i]] - corners[face.corners[0]]);
            }
            surface += face.node == kBorder ? 0.0 : 0.5 * glm::length(twice_area);
        }
        EXPECT_NEAR(touched[leaf], surface, 1e-7) << "leaf " << leaf;
    }
}

TEST(CellAdjacency, OfOneLeafAreNone) {
    EXPECT_TRUE(cell_adjacencies(ViewCells({Vec3(0.0), Vec3(1.0)})).empty());
}

}  // namespace
}  // namespace earshot::visibility
