// SPDX-License-Identifier: MIT
#include "earshot/collision/discrete.h"

#include "earshot/base/error.h"
#include "earshot/base/simd.h"
#include "earshot/collision/narrow_phase/triangle_distance.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/query_meshes.h"
#include <algorithm>
#include <optional>

namespace earshot::collision {
namespace {

using geometry::Mesh;
using geometry::Segment;
using geometry::Vec3;

glm::dmat3 random_rotation(std::uint64_t seed, std::uint64_t i) {
    const Vec3 x = glm::normalize(test::random_point(seed, 2 * i));
    const Vec3 y = glm::normalize(glm::cross(x, test::random_point(seed, 2 * i + 1)));
    return {x, y, glm::cross(x, y)};
}

Corners placed(const Mesh& mesh, const Pose& pose, std::size_t triangle) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = pose.apply(mesh.positions[mesh.triangles[triangle][k]]);
    }
    return corners;
}

struct Answers {
    std::vector<TrianglePair> contacts;
    MeshDistance nearest;
    friend bool operator==(const Answers&, const Answers&) = default;
};

Answers by_brute_force(const Mesh& a, const Pose& a_pose, const Mesh& b, const Pose& b_pose) {
    Answers answers;
    for (geometry::TriangleId i = 0; i < a.triangles.size(); ++i) {
        for (geometry::TriangleId k = 0; k < b.triangles.size(); ++k) {
            const TriangleDistance here = distance(placed(a, a_pose, i), placed(b, b_pose, k));
            if (here.distance == 0.0) {
                answers.contacts.push_back({i, k});
            }
            if (here.distance < answers.nearest.distance) {
                answers.nearest = {here.distance, {i, k}, here.on_one, here.on_other};
            }
        }
    }
    if (!answers.contacts.empty()) {
        answers.nearest = {.distance = 0.0};
    }
    return answers;
}

Answers by_trees(const Body& a, const Body& b, Executor& executor = Executor::serial()) {
    Answers answers{find_contacts(a, b, executor), distance(a, b)};
    EXPECT_EQ(intersects(a, b), !answers.contacts.empty());
    return answers;
}

/// b's mesh is as large as a's, and near it.
struct Scene {
    Mesh a, b;
    Pose a_pose, b_pose;
};

Scene random_scene(std::uint64_t i) {
    Scene scene;
    const bool is_soup = i % 3 == 0;
    scene.a = is_soup ? test::degenerate_soup(i, 40) : test::sphere(2, 1.0, Vec3(0.0));
    scene.b = i % 3 == 1 ? test::cube(3, 0.7) : test::triangle_soup(i + 1, 60);
    if (i % 5 == 0) {  // as plain positions, and with contact of corners and edges
        scene.a = test::cube(2, 0.5);
        scene.b = test::cube(3, 0.5);
        scene.b_pose.translation = {
            i % 2 == 0 ? 1.0 : 1.25, 0.25 * static_cast<double>(i % 6), 0.5};
        return scene;
    }
    const double scale = std::ldexp(1.0, static_cast<int>(i * 13 % 151) - 96);
    for (Mesh* mesh : {&scene.a, &scene.b}) {
        for (Vec3& position : mesh->positions) {
            position *= scale;
        }
    }
    scene.a_pose = {random_rotation(20, i), scale * test::random_point(21, i)};
    const double far = i % 4 == 0 ? 5.0 : 1.8;
    scene.b_pose = {random_rotation(22, i), scale * far * test::random_point(23, i)};
    return scene;
}

TEST(Discrete, AnswersAsAllPairsDoAtEveryScale) {
    int touching = 0;
    constexpr int kScenes = 120;
    for (std::uint64_t i = 0; i < kScenes; ++i) {
        SCOPED_TRACE(i);
        const Scene scene = random_scene(i);
        const Answers expected = by_brute_force(scene.a, scene.a_pose, scene.b, scene.b_pose);
        const Shape a = Shape::build(scene.a.view());
        const Shape b = Shape::build(scene.b.view());
        ASSERT_EQ(by_trees({a, scene.a_pose}, {b, scene.b_pose}), expected);
        touching += expected.contacts.empty() ? 0 : 1;
    }
    EXPECT_GT(touching, kScenes / 4);
    EXPECT_LT(touching, kScenes * 3 / 4);
}

TEST(Discrete, DoesNotDependOnBuilderThreadsOrInstructions) {
    const auto mesh = test::sphere(4, 1.0, Vec3(0.0));
    const auto soup = test::degenerate_soup(5, 900);
    Executor two(2);
    for (const double far : {0.3, 3.5}) {
        const Pose pose{random_rotation(30, 1), {far, far, 0.25}};
        std::optional<Answers> expected;
        for (const auto builder : {bvh::Builder::binned_sah,
                                   bvh::Builder::spatial_median,
                                   bvh::Builder::lbvh,
                                   bvh::Builder::quality}) {
            const Shape a = Shape::build(mesh.view(), {.builder = builder});
            const Shape b = Shape::build(soup.view(), {.builder = builder}, two);
            for (const auto& target : simd_targets()) {
                override_simd_target(target);
                const Answers found = by_trees({a}, {b, pose}, two);
                expected = expected.value_or(found);
                EXPECT_EQ(found, *expected) << target;
            }
            override_simd_target("auto");
            EXPECT_EQ(by_trees({a}, {b, pose}), *expected);
        }
        EXPECT_EQ(expected->contacts.empty(), far > 1.0);
    }
}

TEST(Discrete, FollowsAnUpdate) {
    auto a = test::sphere(3, 1.0, Vec3(0.0));
    const auto b = test::cube(4, 0.9);
    Shape moving = Shape::build(a.view());
    const Shape still = Shape::build(b.view());
    for (Vec3& position : a.positions) {
        position = {position.z, 2.0 * position.x, position.y + 0.1};
    }
    moving.update(a.view());
    EXPECT_EQ(by_trees({moving}, {still}), by_brute_force(a, {}, b, {}));
    for (Vec3& position : a.positions) {
        position.x += 4.0;
    }
    moving.update(a.view());
    EXPECT_EQ(by_trees({moving}, {still}), by_brute_force(a, {}, b, {}));
}

TEST(Discrete, LeavesAreTheMeshsTriangles) {
    auto mesh = test::triangle_soup(60, 100);
    Shape shape = Shape::build(mesh.view());
    for (Vec3& position : mesh.positions) {
        position = {position.y, -position.z, position.x};
    }
    shape.update(mesh.view());
    std::vector<geometry::TriangleId> triangles(shape.triangles().begin(), shape.triangles().end());
    ASSERT_EQ(shape.corners().size(), triangles.size());
    for (std::size_t leaf = 0; leaf < triangles.size(); ++leaf) {
        EXPECT_EQ(shape.corners()[leaf], placed(mesh, {}, triangles[leaf])) << leaf;
    }
    std::sort(triangles.begin(), triangles.end());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        ASSERT_EQ(triangles.at(i), i);
    }
}

TEST(Discrete, SegmentsLieOnBothTriangles) {
    const auto a = test::sphere(3, 1.0, Vec3(0.0));
    const Shape shape = Shape::build(a.view());
    const Body still{shape};
    const Body moved{shape, {random_rotation(40, 0), {0.5, 0.6, 0.7}}};
    const auto pairs = find_contacts(still, moved);
    const auto segments = contact_segments(still, moved, pairs);
    ASSERT_EQ(segments.size(), pairs.size());
    ASSERT_GT(pairs.size(), 20U);
    for (const Segment& segment : segments) {
        // Both spheres' facets, 0.2 wide, lie at most 0.2^2 inside.
        EXPECT_NEAR(glm::length(segment.from), 1.0, 0.04);
        EXPECT_NEAR(glm::length(segment.to - moved.pose.translation), 1.0, 0.04);
    }
}

TEST(Discrete, KnowsNothingOfEmptyMeshes) {
    const Mesh none;
    const auto sphere = test::sphere(1, 1.0, Vec3(0.0));
    const Shape empty = Shape::build(none.view());
    const Shape full = Shape::build(sphere.view());
    EXPECT_FALSE(intersects({empty}, {full}));
    EXPECT_TRUE(find_contacts({full}, {empty}).empty());
    EXPECT_TRUE(find_self_contacts({empty}).empty());
    EXPECT_EQ(distance({empty}, {full}), MeshDistance{});
}

TEST(Discrete, RefusesPosesThatAreNotRigid) {
    const auto sphere = test::sphere(1, 1.0, Vec3(0.0));
    const Shape shape = Shape::build(sphere.view());
    EXPECT_THROW(intersects({shape}, {shape, {.rotation = glm::dmat3(1.001)}}), Error);
    EXPECT_THROW(intersects({shape}, {shape, {.translation = Vec3(std::nan(""))}}), Error);
    const Mesh far{{{1e30, 0, 0}, {0, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    EXPECT_THROW(Shape::build(far.view()), Error);
}

}  // namespace
}  // namespace earshot::collision
