// SPDX-License-Identifier: MIT
#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/trace.h"

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

}  // namespace
}  // namespace earshot::frustum
