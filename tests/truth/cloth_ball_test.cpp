// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/moving_meshes.h"
#include "support/test_paths.h"
#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>

namespace earshot::collision {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

std::filesystem::path pose(const char* name) {
    return test::shared_file("models") / name;
}

/// Vertices that share a cell of a grid become one: where the first of them is.
MovingMesh decimated(const MovingMesh& whole, double cell) {
    MovingMesh mesh;
    std::map<std::tuple<long, long, long>, VertexId> numbers;
    std::vector<VertexId> number_of;
    for (std::size_t i = 0; i < whole.begin.size(); ++i) {
        const Vec3 p = whole.begin[i] / cell;
        const auto [at, is_new] =
            numbers.try_emplace({std::lround(p.x), std::lround(p.y), std::lround(p.z)},
                                static_cast<VertexId>(mesh.begin.size()));
        if (is_new) {
            mesh.begin.push_back(whole.begin[i]);
            mesh.end.push_back(whole.end[i]);
        }
        number_of.push_back(at->second);
    }
    for (const Triangle& t : whole.triangles) {
        const Triangle merged{number_of[t[0]], number_of[t[1]], number_of[t[2]]};
        if (merged[0] != merged[1] && merged[1] != merged[2] && merged[2] != merged[0]) {
            mesh.triangles.push_back(merged);
        }
    }
    return mesh;
}

// A step of the cloth on a ball of the UNC Dynamic Scene Benchmarks.
TEST(ClothBall, ContactsAreThoseOfAllPairsOfElements) {
    if (!std::filesystem::exists(pose("cloth_ball92.ply"))) {
        GTEST_SKIP() << "needs cloth_ball92.ply and cloth_ball93.ply";
    }
    const auto begin = io::load_scene(pose("cloth_ball92.ply"), {}).scene.mesh;
    const auto end = io::load_scene(pose("cloth_ball93.ply"), {}).scene.mesh;
    MovingMesh whole;
    whole.triangles = begin.triangles();
    whole.begin = begin.positions_at(0.0);
    whole.end = end.positions_at(0.0);
    double size = 0.0;
    for (const Vec3& p : whole.begin) {
        size = std::max(size, std::abs(p.x - whole.begin[0].x));
    }
    const MovingMesh mesh = decimated(whole, size / 24.0);
    const std::set<Found> expected = brute_force({mesh}, false, true);
    EXPECT_GT(expected.size(), 100U);
    for (int turned_off = 0; turned_off < 4; ++turned_off) {
        World world = world_of({mesh});
        std::set<Found> contacts;
        for (const Contact& contact : world.contacts({.between_meshes = false,
                                      .within_meshes = true,
                                      .track_front = turned_off != 1,
                                      .cull_with_normal_cones = turned_off != 2,
                                      .assign_representatives = turned_off != 3})) {
            EXPECT_TRUE(contacts.insert(found(contact)).second);
        }
        EXPECT_EQ(contacts, expected) << turned_off;
    }
}

}  // namespace
}  // namespace earshot::collision
