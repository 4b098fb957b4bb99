// SPDX-License-Identifier: MIT
#include "earshot/geometry/feature_edges.h"

#include <gtest/gtest.h>

#include "geometry/made_meshes.h"
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace earshot::geometry {
namespace {

FeatureEdges of(const Mesh& mesh, std::vector<std::uint32_t> labels = {}) {
    labels.resize(mesh.triangles.size());
    return find_feature_edges(mesh.view(), labels);
}

std::size_t patches(const FeatureEdges& found) {
    return std::set<std::uint32_t>(found.patch_of_triangle.begin(), found.patch_of_triangle.end())
        .size();
}

// However a box is cut, its features are its twelve edges: 12 n pieces where a face is n x n.
TEST(FeatureEdges, OfABoxAreItsEdges) {
    for (const int cuts : {1, 4}) {
        const FeatureEdges found = of(box_mesh({7.0, 3.5, 11.25}, cuts));
        EXPECT_EQ(found.edges.size(), 12U * static_cast<std::size_t>(cuts));
        EXPECT_EQ(patches(found), 6U);
        for (std::size_t edge = 0; edge < found.edges.size(); ++edge) {
            EXPECT_EQ(found.beside(edge).size(), 2U);
            EXPECT_LT(found.edges[edge][0], found.edges[edge][1]);
        }
        EXPECT_EQ(found.patch_of_triangle.front(), 0U);
    }
}

/// Two unit squares side by side, of two triangles each, the second tilted about the common edge.
Mesh hinge(double angle) {
    const double x = 1.0 + std::cos(angle), y = std::sin(angle);
    return {.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {x, y, 0}, {x, y, 1}},
            .triangles = {{0, 2, 1}, {0, 3, 2}, {1, 2, 5}, {1, 5, 4}}};
}

TEST(FeatureEdges, AreCreasesFromTheAngleOn) {
    const double angle = std::acos(kCreaseCosine);
    EXPECT_EQ(of(hinge(0.0)).edges.size(), 6U);
    EXPECT_EQ(of(hinge(0.99 * angle)).edges.size(), 6U);
    EXPECT_EQ(patches(of(hinge(0.99 * angle))), 1U);
    EXPECT_EQ(of(hinge(1.01 * angle)).edges.size(), 7U);
    EXPECT_EQ(patches(of(hinge(1.01 * angle))), 2U);
}

TEST(FeatureEdges, WindingPlaysNoPart) {
    Mesh mesh = hinge(0.0);
    std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
    EXPECT_EQ(of(mesh).edges.size(), 6U);
    // A sheet folded back on itself is a crease, whichever way its halves are wound.
    Mesh folded = hinge(3.0);
    EXPECT_EQ(of(folded).edges.size(), 7U);
    std::swap(folded.triangles[2][0], folded.triangles[2][1]);
    EXPECT_EQ(of(folded).edges.size(), 7U);
}

TEST(FeatureEdges, AreWhereLabelsChange) {
    const FeatureEdges found = of(hinge(0.0), {3, 3, 3, 4});
    EXPECT_EQ(found.edges.size(), 7U);
    EXPECT_EQ(patches(found), 2U);
}

TEST(FeatureEdges, AreWhereASurfaceBranches) {
    Mesh mesh = hinge(0.0);
    mesh.positions.emplace_back(1.0, 1.0, 0.5);
    mesh.triangles.push_back({1, 2, 6});
    const FeatureEdges found = of(mesh);
    EXPECT_EQ(found.edges.size(), 6U + 1U + 2U);
    EXPECT_EQ(patches(found), 3U);
    const auto branch =
        std::find(found.edges.begin(), found.edges.end(), std::array<VertexId, 2>{1, 2});
    ASSERT_NE(branch, found.edges.end());
    const auto beside = found.beside(static_cast<std::size_t>(branch - found.edges.begin()));
    EXPECT_EQ(std::vector<TriangleId>(beside.begin(), beside.end()),
              (std::vector<TriangleId>{0, 2, 4}));
}

TEST(FeatureEdges, TakeDuplicatesAndDegenerateTriangles) {
    Mesh mesh = hinge(0.0);
    mesh.positions.insert(mesh.positions.end(), {{1, 0, 0}, {1, 0, 1}});  // as vertices 1 and 2
    mesh.triangles[2] = {6, 7, 5};
    mesh.triangles.push_back({0, 2, 1});
    mesh.triangles.push_back({0, 0, 1});
    const FeatureEdges found = of(mesh);
    EXPECT_EQ(found.edges.size(), 6U);
    EXPECT_EQ(found.patch_of_triangle, (std::vector<std::uint32_t>{0, 0, 0, 0, 0, 1}));
    EXPECT_TRUE(of({}).edges.empty());
}

}  // namespace
}  // namespace earshot::geometry
