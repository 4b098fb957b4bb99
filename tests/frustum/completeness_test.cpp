// SPDX-License-Identifier: MIT
#include "earshot/frustum/brute_force.h"
#include "earshot/frustum/find_specular_paths.h"

#include <glm/mat3x3.hpp>
#include <gtest/gtest.h>

#include "frustum/meshed_scene.h"
#include "support/dice.h"
#include "support/random_rooms.h"
#include <cmath>
#include <string>

namespace earshot::frustum {
namespace {

using geometry::Vec3;

// Complete mode against every sequence of facets, at several resolutions. Returns how many paths
// there are.
std::size_t expect_nothing_missed(const SceneView& scene_view,
                                  const Vec3& source,
                                  const std::vector<Vec3>& listeners,
                                  int order) {
    const auto expected =
        find_specular_paths_brute_force(scene_view, source, listeners, order).paths;
    for (const int resolution : {1, 6, 32, 43}) {
        const auto found = find_specular_paths(
            scene_view,
            source,
            listeners,
            {.max_order = order, .resolution = resolution, .box_lattice = false});
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
        scene.scene_view(), {10000.5, -1998.5, 7004.0}, {{10003.25, -1999.25, 7002.5}}, 1);
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
    const auto paths = find_specular_paths(scene.scene_view(),
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
    EXPECT_EQ(expect_nothing_missed(scene.scene_view(), {1e-6, 2.0, 1e-6}, {{1.0, 2.5, 1.5}}, 2),
              4U);
}

glm::dmat3 random_turn(support::Dice& dice) {
    glm::dmat3 turn(1.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double angle = dice.between(0.0, 6.0);
        glm::dmat3 step(1.0);
        const int i = (axis + 1) % 3;
        const int j = (axis + 2) % 3;
        step[i][i] = step[j][j] = std::cos(angle);
        step[i][j] = std::sin(angle);
        step[j][i] = -std::sin(angle);
        turn = step * turn;
    }
    return turn;
}

/// A room of random_room() turned, ten kilometres away, of a millimetre, stored as floats, or all
/// of it, with points in the air, on walls, a hair before them, in the middle (a listener at the
/// source) or far outside.
struct DifficultRoom {
    geometry::Mesh mesh;
    std::vector<std::uint32_t> labels;
    Vec3 source{0.0};
    std::vector<Vec3> listeners;

    explicit DifficultRoom(std::uint64_t seed) {
        support::Dice dice(seed);
        const support::Room room = support::random_room(seed);
        mesh = room.mesh;
        labels = room.labels;
        Vec3 lower = mesh.positions.front();
        Vec3 upper = lower;
        for (const Vec3& p : mesh.positions) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
        const int place = dice.below(5);
        const auto point = [&] {
            Vec3 p;
            for (int axis = 0; axis < 3; ++axis) {
                p[axis] = dice.between(lower[axis], upper[axis]);
            }
            const int axis = dice.below(3);
            if (place == 1) {
                p[axis] = lower[axis];
            } else if (place == 2) {
                p[axis] = lower[axis] + std::pow(10.0, -dice.between(1.0, 13.0));
            } else if (place == 3) {
                p = 0.5 * (lower + upper);
            } else if (place == 4 && dice.chance(0.5)) {
                p *= std::pow(10.0, dice.between(1.0, 7.0));
            }
            return p;
        };
        source = point();
        listeners = {point(), point()};
        const glm::dmat3 turn = dice.chance(0.5) ? random_turn(dice) : glm::dmat3(1.0);
        const double scale = dice.chance(0.2) ? 1e-3 / glm::distance(lower, upper) : 1.0;
        const Vec3 shift = dice.chance(0.2) ? Vec3(1e4, -2e3, 7e3) : Vec3(0.0);
        const auto move = [&](const Vec3& p) { return scale * (turn * p) + shift; };
        const bool as_floats = dice.chance(0.5);
        for (Vec3& p : mesh.positions) {
            p = move(p);
            for (int axis = 0; axis < 3 && as_floats; ++axis) {
                p[axis] = static_cast<double>(static_cast<float>(p[axis]));
            }
        }
        source = move(source);
        for (Vec3& listener : listeners) {
            listener = move(listener);
        }
    }
};

TEST(Completeness, DifficultRoomsHideNothing) {
    constexpr double kMaxSequences = 1e4;
    std::size_t paths = 0;
    for (std::uint64_t seed = 0; seed < 70; ++seed) {
        const DifficultRoom room(seed);
        const MeshedScene scene(room.mesh, room.labels);
        const auto facets = static_cast<double>(scene.facets().facets.size());
        int order = 1;
        while (order < 4 && std::pow(facets, order + 1) < kMaxSequences) {
            ++order;
        }
        SCOPED_TRACE("seed " + std::to_string(seed));
        paths += expect_nothing_missed(scene.scene_view(), room.source, room.listeners, order);
    }
    EXPECT_GT(paths, 1000U);
}

}  // namespace
}  // namespace earshot::frustum
