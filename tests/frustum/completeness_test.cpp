// SPDX-License-Identifier: MIT
#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/trace.h"

#include <glm/mat3x3.hpp>
#include <gtest/gtest.h>

#include "frustum/meshed_scene.h"

namespace earshot::frustum {
namespace {

using geometry::Vec3;

// Complete mode against every sequence of facets, at several resolutions. Returns how many paths
// there are.
std::size_t expect_nothing_missed(const Surroundings& surroundings,
                                  const Vec3& source,
                                  const std::vector<Vec3>& listeners,
                                  int order) {
    const auto expected =
        find_specular_paths_brute_force(surroundings, source, listeners, order).paths;
    for (const int resolution : {1, 6, 32, 43}) {
        const auto found = find_specular_paths(
            surroundings, source, listeners, {.max_order = order, .resolution = resolution});
        EXPECT_EQ(found.paths, expected) << "resolution " << resolution;
    }
    return expected.size();
}

// Ten kilometres from the origin a plate of two millimetres is narrower than the tolerance of its
// outline, which leaves out one of its four corners. The source floats half a millimetre before it.
TEST(Completeness, AnOutlineCoarserThanItsDistanceFromTheSourceLosesNothing) {
    geometry::Mesh mesh;
    mesh.positions = {{10000.4985, -1999.9996, 7003.9990},
                      {10000.4986, -1998.4261, 7004.0},
                      {10000.5000526, -1998.4262, 7004.0004883},
                      {10000.5013784, -1999.9997, 7004.0009766}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const MeshedScene scene(mesh);
    ASSERT_EQ(scene.facets().facets.size(), 1U);
    ASSERT_EQ(scene.facets().facets[0].loops[0].size(), 3U);
    const std::size_t paths = expect_nothing_missed(
        scene.surroundings(), {10000.5, -1998.5, 7004.0}, {{10003.25, -1999.25, 7002.5}}, 1);
    EXPECT_EQ(paths, 2U);
}

// A carpet on the floor of a turned room, stored as floats: the two planes differ by rounding, and
// so do the lengths of the ways over the one and the other.
TEST(Completeness, ACarpetDoesNotDoubleTheFloorInATurnedRoom) {
    const glm::dmat3 turn = {Vec3(0.8, 0.36, 0.48), Vec3(-0.6, 0.48, 0.64), Vec3(0.0, -0.8, 0.6)};
    geometry::Mesh mesh;
    const auto add_rectangle = [&](double left, double right) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        for (const Vec3& corner : {Vec3(left, left, 0),
                                   Vec3(right, left, 0),
                                   Vec3(right, right, 0),
                                   Vec3(left, right, 0)}) {
            mesh.positions.push_back(turn * corner);
            for (int axis = 0; axis < 3; ++axis) {
                double& coordinate = mesh.positions.back()[axis];
                coordinate = static_cast<double>(static_cast<float>(coordinate));
            }
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    };
    add_rectangle(0.0, 10.1);
    add_rectangle(3.3, 6.7);
    const MeshedScene scene(mesh, {0, 0, 1, 1});
    ASSERT_EQ(scene.facets().facets.size(), 2U);
    const auto paths = find_specular_paths(scene.surroundings(),
                                           turn * Vec3(4.5, 4.6, 1.3),
                                           std::vector<Vec3>{turn * Vec3(5.1, 5.2, 1.7)},
                                           {.max_order = 2})
                           .paths;
    ASSERT_EQ(paths.size(), 2U);
    EXPECT_TRUE(paths[0].triangles.empty());
    EXPECT_LT(paths[1].triangles[0], 2U);  // the lowest triangle stands
}

// A source a micrometre from two walls has an image in each, and they sound together.
TEST(Completeness, ImagesCloserThanTheToleranceInDifferentWallsAreNotOne) {
    geometry::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const MeshedScene scene(mesh);
    EXPECT_EQ(expect_nothing_missed(scene.surroundings(), {1e-6, 2.0, 1e-6}, {{1.0, 2.5, 1.5}}, 2),
              4U);
}

}  // namespace
}  // namespace earshot::frustum
