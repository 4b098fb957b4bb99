// SPDX-License-Identifier: MIT
#include "earshot/visibility/sample_free_segments.h"

#include "earshot/base/error.h"
#include "earshot/bvh/brute_force.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/rooms.h"
#include <cmath>
#include <limits>

namespace earshot::visibility {
namespace {

using geometry::Vec3;
using support::Facing;
using support::Room;

constexpr std::uint64_t kSeed = 5;

const Vec3 kLower = {0.0, 0.0, 0.0};
const Vec3 kUpper = {4.0, 3.0, 5.0};
const ViewRegion kInside = {kLower + 0.01, kUpper - 0.01};
const ViewRegion kSolid = {{1.0, 0.5, 1.0}, {2.5, 2.0, 3.0}};

bvh::WideTree tree_of(const geometry::Mesh& mesh) {
    return bvh::WideTree::build(bvh::Tree::build(bvh::triangle_boxes(mesh.view())), mesh.view());
}

std::vector<FreeSegment> sample(const geometry::Mesh& mesh,
                                const ViewRegion& region,
                                const SegmentSampling& sampling,
                                int threads = 1) {
    Executor executor(threads);
    return sample_free_segments({tree_of(mesh), mesh.view()}, region, sampling, executor);
}

Room room_with_solid() {
    Room room = support::box_room(kLower, kUpper);
    support::add_hexahedron(
        room, support::box_corners(kSolid.lower, kSolid.upper), Facing::outward, 6);
    return room;
}

Vec3 middle(const FreeSegment& free) {
    return 0.5 * (free.segment.from + free.segment.to);
}

bool are_same(const std::vector<FreeSegment>& a, const std::vector<FreeSegment>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
        return x.segment.from == y.segment.from && x.segment.to == y.segment.to &&
               x.at_from == y.at_from && x.at_to == y.at_to;
    });
}

TEST(SampleFreeSegments, InAClosedBoxReachFromWallToAnotherWall) {
    const Room room = support::box_room(kLower, kUpper);
    const auto segments = sample(room.mesh, kInside, {.seed = kSeed, .count = 3000});
    ASSERT_EQ(segments.size(), 3000U);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const FreeSegment& free = segments[i];
        ASSERT_NE(free.at_from, kNoTriangle) << "sample " << i;
        ASSERT_NE(free.at_to, kNoTriangle) << "sample " << i;
        ASSERT_NE(room.labels[free.at_from], room.labels[free.at_to]) << "sample " << i;
        const Vec3 direction = free.segment.to - free.segment.from;
        const auto ahead =
            bvh::brute_force::closest_hit(room.mesh.view(), {middle(free), direction});
        const auto behind =
            bvh::brute_force::closest_hit(room.mesh.view(), {middle(free), -direction});
        ASSERT_TRUE(ahead && behind) << "sample " << i;
        ASSERT_EQ(ahead->triangle, free.at_to) << "sample " << i;
        ASSERT_EQ(behind->triangle, free.at_from) << "sample " << i;
    }
}

TEST(SampleFreeSegments, BeginInSolidsAsOftenAsTheirVolumeSays) {
    const Room room = room_with_solid();
    constexpr std::size_t kCount = 20000;
    const auto segments = sample(room.mesh, kInside, {.seed = kSeed, .count = kCount});
    ASSERT_EQ(segments.size(), kCount);
    const auto inside = static_cast<double>(
        std::count_if(segments.begin(), segments.end(), [](const FreeSegment& free) {
            return kSolid.contains(middle(free));
        }));
    const double share = kSolid.volume() / kInside.volume();
    EXPECT_NEAR(inside, kCount * share, 4.0 * std::sqrt(kCount * share * (1.0 - share)));
}

TEST(SampleFreeSegments, LeaveSolidsOutOnRequest) {
    const Room room = room_with_solid();
    const auto segments =
        sample(room.mesh, kInside, {.seed = kSeed, .count = 20000, .skip_solids = true});
    // In a closed scene each sample finds its way out of the one solid.
    EXPECT_EQ(segments.size(), 20000U);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        for (const double part : {0.001, 0.5, 0.999}) {
            const auto& [from, to] = segments[i].segment;
            ASSERT_FALSE(kSolid.contains(from + part * (to - from))) << "sample " << i;
        }
    }
}

TEST(SampleFreeSegments, GiveUpWhereSolidsDoNotEnd) {
    // Twenty sheets that all face +x: a ray along +x hits the back of each, as if it left a solid
    // each time, and is outside after the last, before a wall that faces it.
    geometry::Mesh mesh;
    for (unsigned i = 0; i < 20; ++i) {
        const double x = i;
        for (const Vec3& corner : {Vec3(x, -1e4, -1e4), Vec3(x, 2e4, -1e4), Vec3(x, -1e4, 2e4)}) {
            mesh.positions.push_back(corner);
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    for (const Vec3& corner : {Vec3(25.0, -1e4, -1e4), {25.0, -1e4, 2e4}, {25.0, 2e4, -1e4}}) {
        mesh.positions.push_back(corner);
    }
    mesh.triangles.push_back({60, 61, 62});
    const ViewRegion region = {{-0.5, -1.0, -1.0}, {18.5, 1.0, 1.0}};
    constexpr std::size_t kCount = 20000;
    const auto segments =
        sample(mesh, region, {.seed = kSeed, .count = kCount, .skip_solids = true});
    const auto between = static_cast<double>(
        std::count_if(segments.begin(), segments.end(), [](const FreeSegment& free) {
            return free.at_from == 19 && free.at_to == 20;
        }));
    // Half of the directions go along +x, and at most eight sheets are passed: the origin is less
    // than eight metres from the last, at x = 19. The others never lie between two fronts, but for
    // the few along the sheets.
    EXPECT_GT(between, 0.99 * static_cast<double>(segments.size()));
    const double share = 0.5 * 7.5 / 19.0;
    EXPECT_NEAR(between, kCount * share, 4.0 * std::sqrt(kCount * share * (1.0 - share)));
}

TEST(SampleFreeSegments, AreTheSameForAnyThreadsAndInParts) {
    const Room room = room_with_solid();
    const SegmentSampling all = {.seed = kSeed, .count = 150000, .skip_solids = true};
    const auto segments = sample(room.mesh, kInside, all);
    for (const int threads : {2, 8}) {
        EXPECT_TRUE(are_same(segments, sample(room.mesh, kInside, all, threads)));
    }
    SegmentSampling part = all;
    part.count = 70001;
    auto joined = sample(room.mesh, kInside, part);
    part.first = part.count;
    part.count = all.count - part.count;
    const auto rest = sample(room.mesh, kInside, part);
    joined.insert(joined.end(), rest.begin(), rest.end());
    EXPECT_TRUE(are_same(segments, joined));
    EXPECT_FALSE(are_same(segments, sample(room.mesh, kInside, {.seed = 6, .count = 150000})));
}

TEST(SampleFreeSegments, PassFlatRegionsAndAreEmptyWithoutAMesh) {
    const Room room = support::box_room(kLower, kUpper);
    const ViewRegion ear = {{0.1, 1.5, 0.1}, {3.9, 1.5, 4.9}};
    for (const FreeSegment& free : sample(room.mesh, ear, {.seed = kSeed, .count = 500})) {
        EXPECT_LE(std::min(free.segment.from.y, free.segment.to.y), 1.5);
        EXPECT_GE(std::max(free.segment.from.y, free.segment.to.y), 1.5);
    }
    EXPECT_TRUE(sample({}, kInside, {.count = 100}).empty());
    EXPECT_TRUE(sample({}, kInside, {.count = 100, .skip_solids = true}).empty());
}

TEST(SampleFreeSegments, RefuseInvalidRegions) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double far = std::numeric_limits<double>::infinity();
    EXPECT_THROW(sample({}, {Vec3(0.0), {1.0, 1.0, nan}}, {}), Error);
    EXPECT_THROW(sample({}, {Vec3(0.0), {1.0, far, 1.0}}, {}), Error);
    EXPECT_THROW(sample({}, {Vec3(0.0), {-1.0, 1.0, 1.0}}, {}), Error);
}

}  // namespace
}  // namespace earshot::visibility
