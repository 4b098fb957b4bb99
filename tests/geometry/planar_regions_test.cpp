// SPDX-License-Identifier: MIT
#include "earshot/geometry/planar_regions.h"

#include "earshot/base/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "made_meshes.h"
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace earshot::geometry {
namespace {

/// Equal positions as one vertex, as the precondition asks.
Mesh welded(const Mesh& mesh) {
    const auto less = [](const Vec3& a, const Vec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    std::map<Vec3, VertexId, decltype(less)> number(less);
    Mesh result;
    for (Triangle triangle : mesh.triangles) {
        for (VertexId& vertex : triangle) {
            const Vec3& position = mesh.positions[vertex];
            const auto [entry, is_new] =
                number.emplace(position, static_cast<VertexId>(result.positions.size()));
            if (is_new) {
                result.positions.push_back(position);
            }
            vertex = entry->second;
        }
        result.triangles.push_back(triangle);
    }
    return result;
}

double volume(const Mesh& mesh) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = corners(mesh, t);
        sum += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return sum;
}

TEST(PlanarRegions, TriangulateABoxByItsCorners) {
    const Mesh box = welded(box_mesh({4.0, 2.0, 8.0}, 4));
    const std::vector<std::uint32_t> labels(box.triangles.size(), 0);
    const SimplifiedMesh result = merge_planar_regions(box.view(), labels);
    EXPECT_EQ(result.mesh.triangles.size(), 12U);
    EXPECT_EQ(result.mesh.positions.size(), 8U);
    EXPECT_NEAR(volume(result.mesh), volume(box), 1e-12);
}

TEST(PlanarRegions, NeighboursShareTheVerticesOfTheirBorder) {
    // One side has two labels, whose line ends within edges of the box: these points stay on all
    // sides, or there would be gaps.
    const Mesh box = welded(box_mesh({4.0, 4.0, 4.0}, 4));
    std::vector<std::uint32_t> labels;
    for (std::size_t t = 0; t < box.triangles.size(); ++t) {
        const auto [a, b, c] = corners(box, t);
        const bool is_half =
            a.z == 0.0 && b.z == 0.0 && c.z == 0.0 && std::max({a.x, b.x, c.x}) <= 2.0;
        labels.push_back(is_half ? 1 : 0);
    }
    const SimplifiedMesh result = merge_planar_regions(box.view(), labels);
    std::map<std::pair<VertexId, VertexId>, int> uses;
    for (const Triangle& t : result.mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            ++uses[std::minmax(t[k], t[(k + 1) % 3])];
        }
    }
    EXPECT_TRUE(
        std::all_of(uses.begin(), uses.end(), [](const auto& use) { return use.second == 2; }));
    EXPECT_EQ(result.mesh.positions.size(), 10U);
    EXPECT_EQ(result.mesh.triangles.size(), 16U);
    EXPECT_EQ(std::count_if(result.origins.begin(),
                            result.origins.end(),
                            [&](TriangleId origin) { return labels[origin] == 1; }),
              2);
}

TEST(PlanarRegions, OfCurvedSurfacesAreTheirTriangles) {
    Mesh mesh;
    add_plate(mesh, Vec3(0.0), {1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 6, 6);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.positions[i].y = 0.1 * random(3, 0, i);
    }
    const std::vector<std::uint32_t> labels(mesh.triangles.size(), 0);
    EXPECT_EQ(merge_planar_regions(mesh.view(), labels).mesh.triangles.size(),
              mesh.triangles.size());
}

TEST(PlanarRegions, OfNothingAreNone) {
    EXPECT_TRUE(merge_planar_regions({}, {}).mesh.triangles.empty());
}

}  // namespace
}  // namespace earshot::geometry
