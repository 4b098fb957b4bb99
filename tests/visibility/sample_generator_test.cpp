// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/sample_generator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include <array>
#include <cmath>

namespace earshot::visibility {
namespace {

using geometry::Mesh;
using geometry::Vec3;

constexpr std::uint64_t kSeed = 5;
const ViewRegion kRegion = {{-1.0, -2.0, -3.0}, {3.0, 2.0, 1.0}};

class SampleGeneratorTest : public testing::Test {
protected:
    SampleGeneratorTest()
        : mesh(test::sphere(2, 1.0, {0.0, 0.0, -10.0})),
          objects(std::vector<ObjectId>(mesh.triangles.size(), 0)),
          source(mesh.view(), objects, kRegion, kSeed) {}

    Sample sample(SampleDistribution distribution, std::uint64_t index) const {
        Sample result;
        result.distribution = distribution;
        result.candidate = MutationCandidate{{0.0, 0.0, 0.0}, {0.0, 0.0, -9.0}, 0, 0.25};
        source.draw(result, index);
        return result;
    }

    Mesh mesh;
    Objects objects;  // the sphere as one
    SampleGenerator source;
};

TEST_F(SampleGeneratorTest, ViewSpaceDirectionsAreUniformInRegionAndSphere) {
    constexpr std::uint64_t kCount = 20000;
    Vec3 origins(0.0);
    Vec3 directions(0.0);
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const Sample s = sample(SampleDistribution::view_space_direction, i);
        ASSERT_TRUE(kRegion.contains(s.ray.origin));
        ASSERT_NEAR(glm::length(s.ray.direction), 1.0, 1e-12);
        origins += s.ray.origin / static_cast<double>(kCount);
        directions += s.ray.direction * s.ray.direction / static_cast<double>(kCount);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = 0.5 * (kRegion.lower[axis] + kRegion.upper[axis]);
        EXPECT_NEAR(origins[axis], middle, 0.01);
        EXPECT_NEAR(directions[axis], 1.0 / 3.0, 0.01);
    }
}

TEST_F(SampleGeneratorTest, TwoPointsLeadFromTheRegionToTheObject) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const Sample s = sample(SampleDistribution::two_point, i);
        ASSERT_TRUE(kRegion.contains(s.ray.origin));
        // The sphere's triangles lie up to 2 % inside of it.
        const double radius = glm::distance(s.ray.origin + s.ray.direction, Vec3(0.0, 0.0, -10.0));
        ASSERT_GT(radius, 0.9);
        ASSERT_LE(radius, 1.0 + 1e-12);
    }
}

// After Lambert: the mean cosine to the normal is 2/3.
TEST_F(SampleGeneratorTest, ObjectSurfaceDirectionsAreCosineWeightedOnBothSides) {
    constexpr std::uint64_t kCount = 20000;
    std::array<double, 2> cosines{};
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const Sample s = sample(SampleDistribution::object_surface_direction, i);
        const Vec3 out = glm::normalize(s.ray.origin - Vec3(0.0, 0.0, -10.0));
        cosines[i % 2] += 2.0 * glm::dot(out, s.ray.direction) / static_cast<double>(kCount);
    }
    EXPECT_NEAR(std::abs(cosines[0]), 2.0 / 3.0, 0.02);
    EXPECT_NEAR(cosines[0] + cosines[1], 0.0, 0.02);
}

TEST_F(SampleGeneratorTest, TwoPointMutationsSpreadByTheRadii) {
    constexpr std::uint64_t kCount = 200'000;
    const double radius = source.radius(0);
    EXPECT_NEAR(radius, std::sqrt(3.0), 1e-12);
    Vec3 from_variance(0.0);
    Vec3 to_variance(0.0);
    for (std::uint64_t i = 0; i < kCount; ++i) {
        const geometry::Ray ray = sample(SampleDistribution::two_point_mutation, i).ray;
        const Vec3 from = ray.origin - 0.5 * ray.direction;
        const Vec3 to = ray.origin + 0.5 * ray.direction - Vec3(0.0, 0.0, -9.0);
        from_variance += from * from / static_cast<double>(kCount);
        to_variance += to * to / static_cast<double>(kCount);
    }
    for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(from_variance[axis] / (0.25 * 0.25), 1.0, 0.015);
        EXPECT_NEAR(to_variance[axis] / (radius * radius), 1.0, 0.015);
    }
    EXPECT_NEAR(from_variance.z, 0.0, 1e-24);
    EXPECT_NEAR(to_variance.z, 0.0, 1e-24);
}

TEST_F(SampleGeneratorTest, SilhouetteMutationsPassJustOutsideOfTheObject) {
    const Vec3 from(0.0);
    const Vec3 middle(0.0, 0.0, -9.0);
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const Vec3 aimed_at = sample(SampleDistribution::silhouette_mutation, i).silhouette_point;
        ASSERT_FALSE(source.intersects(from, aimed_at, 0)) << "sample " << i;
        // The search ends a 128th of the way within the border.
        const Vec3 aside = glm::normalize(aimed_at - middle);
        const double step = 2.0 * source.radius(0) / 128.0;
        ASSERT_TRUE(source.intersects(from, aimed_at - 1.01 * step * aside, 0)) << "sample " << i;
    }
}

}  // namespace
}  // namespace earshot::visibility
