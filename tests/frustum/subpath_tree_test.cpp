// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/subpath_tree.h"

#include "earshot/base/simd.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "frustum/quad_room.h"
#include <algorithm>
#include <cmath>

namespace earshot::frustum {
namespace {

using geometry::Vec3;

/// A frustum of any place, direction and width that starts at a plane across it.
struct RandomFrustum {
    RandomFrustum(std::uint64_t seed, double size) {
        const auto dice = [&](std::uint64_t i) { return random_between(seed, 50, i, -1.0, 1.0); };
        frustum.apex = size * Vec3(dice(0), dice(1), dice(2));
        frustum.forward = glm::normalize(Vec3(dice(3), dice(4), dice(5) + 0.01));
        frustum.right = glm::normalize(glm::cross(frustum.forward, Vec3(dice(6), 1.0, dice(7))));
        frustum.up = glm::cross(frustum.right, frustum.forward);
        const double width = std::exp2(-10.0 * std::abs(dice(8)));
        frustum.rect.lower = 0.4 * glm::dvec2(dice(9), dice(10));
        frustum.rect.upper = frustum.rect.lower + glm::dvec2(width, 0.3 * width);
        frustum.starts_at_facet = true;
        frustum.min_depth = 0.05 * size;
        plane.normal = glm::normalize(frustum.forward + 0.3 * frustum.right);
        plane.offset = glm::dot(plane.normal, frustum.apex + 0.1 * size * frustum.forward);
    }

    Frustum frustum;
    geometry::Plane plane;
};

/// A subpath on a ray of the frustum, whose aperture the ray meets in a corner, on a side or
/// inside.
SubpathBounds on_a_ray(const RandomFrustum& from, std::uint64_t seed, double size) {
    const Frustum& frustum = from.frustum;
    const auto dice = [&](std::uint64_t i) { return random_between(seed, 60, i, 0.0, 1.0); };
    const auto border = [&](std::uint64_t i) {
        return dice(i) < 0.3 ? std::round(dice(i + 1)) : dice(i + 1);
    };
    const glm::dvec2 share = {border(0), border(2)};
    const glm::dvec2 uv = frustum.rect.lower + share * (frustum.rect.upper - frustum.rect.lower);
    const Vec3 direction = frustum.forward + uv.x * frustum.right + uv.y * frustum.up;
    const double start = (from.plane.offset - glm::dot(from.plane.normal, frustum.apex)) /
                         glm::dot(from.plane.normal, direction);
    const double depth = start + 2.0 * size * dice(4);
    const Vec3 meets = frustum.apex + depth * direction;
    SubpathBounds bounds;
    bounds.aperture.include(meets);
    bounds.aperture.include(meets + 0.2 * size * Vec3(border(5), border(7) - 1.0, border(9)));
    bounds.image.include(frustum.apex + (depth + 2.0 * size * dice(11)) * direction);
    return bounds;
}

SubpathBounds anywhere(std::uint64_t seed, double size) {
    const auto dice = [&](std::uint64_t i) {
        return size * random_between(seed, 70, i, -1.0, 1.0);
    };
    const Vec3 corner = {dice(0), dice(1), dice(2)};
    SubpathBounds bounds;
    bounds.aperture.include(corner);
    bounds.aperture.include(corner + 0.05 * Vec3(dice(3), dice(4), dice(5)));
    bounds.image.include(3.0 * Vec3(dice(6), dice(7), dice(8)));
    return bounds;
}

TEST(SubpathTree, FindsEverySubpathOnARayOfTheFrustumAndFewOthers) {
    std::size_t others = 0, all_others = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const double size = std::exp2(random_between(seed, 80, 0, -8.0, 12.0));
        const RandomFrustum from(seed, size);
        const std::size_t count = seed < 10 ? seed : 37 * seed;
        std::vector<SubpathBounds> subpaths;
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::uint64_t number = 5000 * seed + i;
            subpaths.push_back(i % 7 == 0 ? on_a_ray(from, number, size) : anywhere(number, size));
        }
        const SubpathTree tree(subpaths, Executor::serial());
        const ConnectingLegs legs(
            from.frustum, from.plane, 1e-12 * size, tree.max_coordinate(), 1e300);
        std::vector<std::uint32_t> expected;
        for (const std::string& target : simd_targets()) {
            override_simd_target(target);
            std::vector<std::uint32_t> found;
            tree.find(legs, found);
            if (expected.empty()) {
                expected = found;
            }
            EXPECT_EQ(found, expected) << target;
        }
        override_simd_target("auto");
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(std::adjacent_find(expected.begin(), expected.end()), expected.end());
        for (std::uint32_t i = 0; i < count; ++i) {
            const bool is_found = std::binary_search(expected.begin(), expected.end(), i);
            if (i % 7 == 0) {
                EXPECT_TRUE(is_found) << seed << ' ' << i;
            } else {
                others += is_found ? 1 : 0;
                ++all_others;
            }
        }
    }
    EXPECT_LT(others, all_others / 200);
}

/// A leg whose ends' coordinates are floats, so that no rounding of boxes makes room, through a
/// corner of a frustum's aperture, in the plane of its start and no farther than its least depth.
struct ExactLeg {
    explicit ExactLeg(std::uint64_t seed) {
        const auto dice = [&](std::uint64_t i) { return random_between(seed, 90, i, -1.0, 1.0); };
        const auto point = [&](std::uint64_t i) {
            return Vec3(Vec3(dice(i), dice(i + 1), dice(i + 2)) * size);
        };
        const Vec3 meets = as_floats(point(0)), image = as_floats(3.0 * point(3));
        Frustum& frustum = from.frustum;
        frustum.apex = meets + std::exp2(2.0 * dice(6)) * (meets - image);
        const Vec3 way = glm::normalize(image - meets);
        frustum.forward = glm::normalize(way + 0.55 * Vec3(dice(7), dice(8), dice(9)));
        frustum.right = glm::normalize(glm::cross(frustum.forward, Vec3(dice(10), 1.0, dice(11))));
        frustum.up = glm::cross(frustum.right, frustum.forward);
        const Vec3 local = frustum.local(meets);
        const glm::dvec2 corner = {local.x / local.z, local.y / local.z};
        const glm::dvec2 width = std::exp2(4.0 * dice(12)) * glm::dvec2(dice(13), dice(14));
        frustum.rect = {.lower = glm::min(corner, corner + width),
                        .upper = glm::max(corner, corner + width)};
        frustum.min_depth = (1.0 - 0x1p-50) * local.z;
        from.plane.normal = glm::normalize(way + 0.55 * Vec3(dice(15), dice(16), dice(17)));
        from.plane.offset = glm::dot(from.plane.normal, meets);
        bounds.aperture.include(meets);
        bounds.image.include(image);
    }

    static Vec3 as_floats(const Vec3& point) { return Vec3(glm::vec3(point)); }

    static constexpr double size = 10.0;
    RandomFrustum from{1, size};
    SubpathBounds bounds;
};

TEST(SubpathTree, FindsLegsInTheBordersOfAFrustum) {
    std::size_t projected = 0, too_wide = 0;
    for (std::uint64_t seed = 0; seed < 20000; ++seed) {
        const ExactLeg leg(seed);
        const SubpathTree tree(std::span(&leg.bounds, 1), Executor::serial());
        const ConnectingLegs legs(
            leg.from.frustum, leg.from.plane, 0.0, tree.max_coordinate(), 1e300);
        (legs.axis >= 0 ? projected : too_wide) += 1;
        std::vector<std::uint32_t> found;
        tree.find(legs, found);
        EXPECT_EQ(found.size(), 1U) << seed;
    }
    EXPECT_GT(projected, 2000U);
    EXPECT_GT(too_wide, 500U);
}

TEST(SubpathTree, LeavesOutWhatIsBehindOrTooFar) {
    RandomFrustum from(1, 1.0);
    from.frustum.apex = Vec3(0.0);
    from.frustum.right = {1, 0, 0};
    from.frustum.up = {0, 1, 0};
    from.frustum.forward = {0, 0, 1};
    from.frustum.rect = {.lower = {-0.5, -0.5}, .upper = {0.5, 0.5}};
    from.plane = {.normal = {0, 0, 1}, .offset = 1.0};
    const auto at = [](double aperture, double image) {
        SubpathBounds bounds;
        bounds.aperture.include(Vec3(-0.1, -0.1, aperture));
        bounds.aperture.include(Vec3(0.1, 0.1, aperture));
        bounds.image.include(Vec3(0.0, 0.0, image));
        return bounds;
    };
    const std::vector<SubpathBounds> subpaths = {
        at(2, 4), at(4, 2), at(0.5, 4), at(-2, -4), at(2, -4), at(2, 40), at(1, 1)};
    const SubpathTree tree(subpaths, Executor::serial());
    const auto found = [&](double max_length) {
        std::vector<std::uint32_t> numbers;
        tree.find({from.frustum, from.plane, 1e-12, tree.max_coordinate(), max_length}, numbers);
        std::sort(numbers.begin(), numbers.end());
        return numbers;
    };
    EXPECT_EQ(found(1e300), (std::vector<std::uint32_t>{0, 5, 6}));
    EXPECT_EQ(found(10.0), (std::vector<std::uint32_t>{0, 6}));
}

}  // namespace
}  // namespace earshot::frustum
