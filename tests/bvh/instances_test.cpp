// SPDX-License-Identifier: MIT
#include "earshot/bvh/instances.h"

#include "earshot/base/error.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/ray.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "support/query_meshes.h"
#include <cmath>
#include <limits>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Ray;
using geometry::Segment;
using geometry::Vec3;

constexpr std::uint64_t kSeed = 51;

/// Turned at random; every third one also scaled, unevenly and through a mirror.
glm::dmat4 transform(std::uint64_t seed, std::uint64_t i, const Vec3& at) {
    glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), at);
    matrix =
        glm::rotate(matrix, random_between(seed, 1, i, -3.0, 3.0), test::random_point(seed, i));
    return i % 3 == 0 ? glm::scale(matrix, Vec3(2.0, -0.25, 0.5)) : matrix;
}

/// Three parts, one of them empty, 60 instances of which some are copies in one place.
class InstancesTest : public ::testing::Test {
protected:
    InstancesTest() {
        for (const Mesh* mesh : {&soup_, &sphere_, &nothing_}) {
            parts_.push_back(scene_.add_part(mesh->view()));
        }
        for (std::uint64_t i = 0; i < 60; ++i) {
            const Vec3 at = 6.0 * test::random_point(kSeed, i);
            matrices_.push_back(i % 5 == 4 ? matrices_.back() : transform(kSeed, i, at));
            scene_.add_instance(parts_[(i - (i % 5 == 4 ? 1 : 0)) % 3], matrices_.back());
        }
        scene_.update();
    }

    Ray ray(std::uint64_t i) const {
        const Vec3 from = 8.0 * test::random_point(kSeed + 1, i);
        const Vec3 to(matrices_[i % matrices_.size()][3]);
        return {from, to + test::random_point(kSeed + 2, i) - from, i % 4 == 0 ? 0.9 : 10.0};
    }

    void expect_brute_force(const char* when) const {
        int hits = 0;
        int blocked = 0;
        for (std::uint64_t i = 0; i < 600; ++i) {
            const auto expected = brute_force::closest_hit(scene_, ray(i));
            ASSERT_EQ(closest_hit(scene_, ray(i)), expected) << when << ", ray " << i;
            const Segment segment{ray(i).origin, ray(i).origin + 0.7 * ray(i).direction};
            const bool is_blocked = brute_force::occluded(scene_, segment);
            ASSERT_EQ(occluded(scene_, segment), is_blocked) << when << ", segment " << i;
            hits += expected ? 1 : 0;
            blocked += is_blocked ? 1 : 0;
        }
        EXPECT_GT(hits, 200) << when;
        EXPECT_GT(blocked, 100) << when;
        EXPECT_LT(blocked, 600) << when;
    }

    Mesh soup_ = test::triangle_soup(kSeed, 150);
    Mesh sphere_ = test::sphere(2, 1.0, {0.5, 0.0, 0.0});
    Mesh nothing_;
    Instances scene_;
    std::vector<PartId> parts_;
    std::vector<glm::dmat4> matrices_;
};

TEST_F(InstancesTest, EqualBruteForce) {
    expect_brute_force("at first");
}

TEST_F(InstancesTest, EqualBruteForceWhenMovedAddedRemoved) {
    for (std::uint64_t frame = 0; frame < 6; ++frame) {
        for (InstanceId id = 0; id < 60; ++id) {
            if (id % 7 == frame % 7) {
                matrices_[id] = transform(kSeed + frame, id, 6.0 * test::random_point(frame, id));
                scene_.set_transform(id, matrices_[id]);
            }
        }
        if (frame % 2 == 0) {
            const auto id = static_cast<InstanceId>(3 + frame);
            scene_.remove_instance(id);
            scene_.remove_instance(id + 20);
            EXPECT_EQ(scene_.add_instance(parts_[1], matrices_[id]),
                      id);  // the lowest that is free
            scene_.add_instance(parts_[0], matrices_[id + 20]);
        }
        EXPECT_FALSE(scene_.is_up_to_date());
        scene_.update();
        EXPECT_TRUE(scene_.is_up_to_date());
        expect_brute_force("frame");
    }
}

TEST_F(InstancesTest, EqualBruteForceWhenAPartDeforms) {
    for (Vec3& position : sphere_.positions) {
        position = {2.0 * position.x, position.y + 0.3 * position.x, position.z};
    }
    scene_.refit_part(parts_[1], sphere_.view());
    scene_.update();
    expect_brute_force("deformed");
}

// However the scene came about, the answers are those of a scene made afresh.
TEST_F(InstancesTest, RefittedTopLevelAnswersAsARebuiltOne) {
    Instances fresh;
    for (const Mesh* mesh : {&soup_, &sphere_, &nothing_}) {
        fresh.add_part(mesh->view());
    }
    for (InstanceId id = 0; id < 60; ++id) {
        const Vec3 at = Vec3(matrices_[id][3]) + 0.5 * test::random_point(kSeed + 9, id);
        matrices_[id] = transform(kSeed + 9, id, at);
        scene_.set_transform(id, matrices_[id]);
        fresh.add_instance((id - (id % 5 == 4 ? 1 : 0)) % 3, matrices_[id]);
    }
    scene_.update();
    fresh.update();
    for (std::uint64_t i = 0; i < 1000; ++i) {
        ASSERT_EQ(closest_hit(scene_, ray(i)), closest_hit(fresh, ray(i))) << i;
    }
}

TEST_F(InstancesTest, BatchesAnswerInOrderForAnyExecutor) {
    std::vector<Ray> rays;
    std::vector<Segment> segments;
    for (std::uint64_t i = 0; i < 700; ++i) {
        rays.push_back(ray(i));
        segments.push_back({rays[i].origin, rays[i].origin + rays[i].direction});
    }
    for (const int threads : {1, 8}) {
        Executor executor(threads);
        const auto hits = closest_hits(scene_, rays, executor);
        const auto blocked = occluded(scene_, segments, executor);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(hits[i], closest_hit(scene_, rays[i])) << i;
            ASSERT_EQ(blocked[i] != 0, occluded(scene_, segments[i])) << i;
        }
    }
}

TEST(Instances, InPlaceAnswerAsTheMeshItself) {
    const auto mesh = test::triangle_soup(kSeed, 500);
    const Tree tree = Tree::build(triangle_boxes(mesh.view()));
    Instances scene;
    scene.add_instance(scene.add_part(mesh.view()));
    scene.update();
    for (std::uint64_t i = 0; i < 4000; ++i) {
        const Vec3 from = 2.0 * test::random_point(kSeed, 2 * i);
        const Ray ray{from, test::random_point(kSeed, 2 * i + 1) - from};
        const auto expected = closest_hit(tree, mesh.view(), ray);
        const auto hit = closest_hit(scene, ray);
        ASSERT_EQ(hit.has_value(), expected.has_value()) << i;
        ASSERT_TRUE(!hit || (hit->instance == 0 && hit->hit == *expected)) << i;
    }
}

TEST(Instances, AreHitWhereTheMovedMeshIs) {
    const auto mesh = test::sphere(3, 1.0, Vec3(0.0));
    const glm::dmat4 matrix = transform(kSeed, 0, {7000.1, -7000.2, 300.3});
    Mesh moved = mesh;
    for (Vec3& position : moved.positions) {
        position = Vec3(matrix * glm::dvec4(position, 1.0));
    }
    const Tree tree = Tree::build(triangle_boxes(moved.view()));
    Instances scene;
    scene.add_instance(scene.add_part(mesh.view()), matrix);
    scene.update();
    for (std::uint64_t i = 0; i < 2000; ++i) {
        // From within, so that rounding at the outline does not matter.
        const Vec3 from = Vec3(matrix[3]) + 0.1 * test::random_point(kSeed, 2 * i);
        const Ray ray{from, test::random_point(kSeed, 2 * i + 1)};
        const auto expected = closest_hit(tree, moved.view(), ray);
        const auto hit = closest_hit(scene, ray);
        ASSERT_TRUE(hit && expected) << i;
        ASSERT_NEAR(hit->hit.t, expected->t, 1e-9 * expected->t) << i;
    }
}

TEST(Instances, OfHitsAtTheSameParameterTheLowestInstanceWins) {
    const auto mesh = test::cube(3, 0.5);
    Instances scene;
    const PartId part = scene.add_part(mesh.view());
    for (int i = 0; i < 9; ++i) {
        scene.add_instance(part);
    }
    scene.remove_instance(0);
    scene.update();
    const auto hit = closest_hit(scene, {{-2, 0, 0}, {1, 0, 0}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->instance, 1U);
    EXPECT_EQ(hit->hit.t, 1.5);
}

TEST(Instances, InvalidQueriesFindNothing) {
    const auto mesh = test::cube(2, 0.5);
    const double nan = std::nan("");
    Instances scene;
    EXPECT_FALSE(closest_hit(scene, {{-2, 0, 0}, {1, 0, 0}}));
    EXPECT_FALSE(occluded(scene, Segment{{-2, 0, 0}, {2, 0, 0}}));
    scene.add_instance(scene.add_part(mesh.view()));
    scene.update();
    EXPECT_TRUE(closest_hit(scene, {{-2, 0, 0}, {1, 0, 0}}));
    EXPECT_TRUE(occluded(scene, Segment{{-2, 0, 0}, {2, 0, 0}}));
    EXPECT_FALSE(closest_hit(scene, {{nan, 0, 0}, {1, 0, 0}}));
    EXPECT_FALSE(closest_hit(scene, {{-2, 0, 0}, {1, nan, 0}}));
    EXPECT_FALSE(closest_hit(scene, {{-2, 0, 0}, {1, 0, 0}, nan}));
    EXPECT_FALSE(occluded(scene, Segment{{nan, 0, 0}, {2, 0, 0}}));
    EXPECT_FALSE(
        occluded(scene, Segment{{0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}}));
}

TEST(Instances, RefuseTransformsWithoutInverse) {
    const auto mesh = test::cube(2, 0.5);
    Instances scene;
    const PartId part = scene.add_part(mesh.view());
    const glm::dmat4 flat = glm::scale(glm::dmat4(1.0), Vec3(1, 0, 1));
    const glm::dmat4 nowhere = glm::translate(glm::dmat4(1.0), Vec3(std::nan(""), 0, 0));
    EXPECT_THROW(scene.add_instance(part, flat), Error);
    EXPECT_THROW(scene.add_instance(part, nowhere), Error);
    const InstanceId id = scene.add_instance(part);
    EXPECT_THROW(scene.set_transform(id, flat), Error);
    scene.update();
    EXPECT_TRUE(closest_hit(scene, {{-2, 0, 0}, {1, 0, 0}}));  // where it was
}

TEST(Instances, PartsComeAndGo) {
    const auto near = test::sphere(1, 0.5, Vec3(0.0));
    const auto far = test::sphere(1, 0.5, {4, 0, 0});
    Instances scene;
    const PartId first = scene.add_part(near.view());
    const InstanceId instance = scene.add_instance(first);
    scene.add_instance(scene.add_part(far.view()));
    scene.update();
    const Ray ray{{-2, 0.01, 0.02}, {1, 0, 0}};
    EXPECT_NEAR(closest_hit(scene, ray)->hit.t, 1.5, 0.1);
    scene.remove_instance(instance);
    scene.remove_part(first);
    scene.update();
    EXPECT_NEAR(closest_hit(scene, ray)->hit.t, 5.5, 0.1);
    EXPECT_EQ(scene.add_part(near.view()), first);
    EXPECT_EQ(scene.add_instance(first), instance);
    scene.update();
    EXPECT_NEAR(closest_hit(scene, ray)->hit.t, 1.5, 0.1);
}

}  // namespace
}  // namespace earshot::bvh
