// SPDX-License-Identifier: MIT
#include "earshot/visibility/build_view_cells.h"

#include "earshot/base/error.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/visibility/cell_shape.h"
#include "earshot/visibility/sample_free_segments.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/rooms.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace earshot::visibility {
namespace {

using geometry::Vec3;
using support::Facing;
using support::Room;

constexpr std::uint64_t kSeed = 9;

const ViewRegion kUnit = {Vec3(0.0), Vec3(1.0)};

/// What is seen along x from one place to another, in the middle of the unit cube.
FreeSegment along_x(double from, double to, geometry::TriangleId end) {
    return {{{from, 0.5, 0.5}, {to, 0.5, 0.5}}, kNoTriangle, end};
}

std::vector<FreeSegment> sampled(const geometry::Mesh& mesh,
                                 const ViewRegion& region,
                                 std::size_t count) {
    const bvh::DeformableBvh hierarchy(mesh.view());
    return sample_free_segments(hierarchy.view(), region, {.seed = kSeed, .count = count});
}

/// Rooms of 4 and 6 m side by side. The wall between them, at x = 3.95 ... 4.05, has a door.
constexpr double kWall = 4.0;
constexpr double kHalfWall = 0.05;

Room rooms_with_door() {
    Room room = support::tessellated_box_room(Vec3(0.0), {10.0, 3.0, 4.0}, 20);
    const auto wall = [&](const Vec3& lower, const Vec3& upper) {
        support::add_hexahedron(room, support::box_corners(lower, upper), Facing::outward, 6);
    };
    wall({kWall - kHalfWall, 0.0, 0.0}, {kWall + kHalfWall, 3.0, 1.5});
    wall({kWall - kHalfWall, 0.0, 2.4}, {kWall + kHalfWall, 3.0, 4.0});
    wall({kWall - kHalfWall, 2.1, 1.5}, {kWall + kHalfWall, 3.0, 2.4});
    return room;
}

const ViewRegion kRooms = {Vec3(0.0), {10.0, 3.0, 4.0}};

/// A soup of triangles and cells among them, with planes of all directions.
struct Soup {
    geometry::Mesh mesh = test::triangle_soup(kSeed, 300);
    ViewRegion region = {Vec3(-1.0), {1.0, 0.8, 0.9}};
    Objects objects = Objects::groups(mesh.view(), 3);
    std::vector<FreeSegment> segments = sampled(mesh, region, 6000);
    CellOptions options;

    Soup() {
        options.max_cells = 60;
        options.mesh = mesh.view();
        options.seed = kSeed;
        options.cost = {2.0, 0.7};
    }
    BuiltCells build(int threads = 1) const {
        Executor executor(threads);
        return build_view_cells(region, segments, objects, options, executor);
    }
};

double cost_of(const BuiltCells& built, std::span<const double> costs) {
    double sum = 0.0;
    for (std::size_t leaf = 0; leaf < built.sets.size(); ++leaf) {
        for (const ObjectId object : built.sets[leaf]) {
            sum += built.viewer_fractions[leaf] * costs[object];
        }
    }
    return sum;
}

TEST(BuildViewCells, HalvesTheCostWhereEachHalfSeesOneObject) {
    const std::vector<FreeSegment> segments = {along_x(0.0, 0.5, 0), along_x(0.5, 1.0, 1)};
    const auto built = build_view_cells(
        kUnit, segments, Objects::triangles(2), {.max_cells = 2, .min_segments = 1});
    EXPECT_EQ(built.region_cost, 2.0);
    ASSERT_EQ(built.splits.size(), 1U);
    EXPECT_EQ(built.splits[0], (CellSplit{0, 1.0, 1.0}));
    ASSERT_EQ(built.cells.nodes().size(), 1U);
    EXPECT_EQ(built.cells.nodes()[0], (CellNode{{1.0, 0.0, 0.0}, 0.5, kCellLeaf, kCellLeaf + 1}));
    EXPECT_EQ(built.sets, (std::vector<std::vector<ObjectId>>{{0}, {1}}));
    EXPECT_EQ(built.viewer_fractions, (std::vector<double>{0.5, 0.5}));
}

TEST(BuildViewCells, SplitsTwoRoomsAtTheWallBetweenThem) {
    const Room room = rooms_with_door();
    const auto segments = sampled(room.mesh, kRooms, 30000);
    const Objects objects = Objects::triangles(room.mesh.triangles.size());
    for (const bool with_mesh : {false, true}) {
        CellOptions options{.max_cells = 2};
        options.mesh = with_mesh ? room.mesh.view() : geometry::MeshView{};
        const auto built = build_view_cells(kRooms, segments, objects, options);
        ASSERT_EQ(built.splits.size(), 1U);
        const CellNode& plane = built.cells.nodes()[0];
        EXPECT_EQ(plane.normal, Vec3(1.0, 0.0, 0.0));
        EXPECT_NEAR(plane.offset, kWall, 1.1 * kHalfWall);
    }
}

TEST(BuildViewCells, FindsTheBestPlaneOfAllSegmentEnds) {
    const Soup soup;
    const auto costs = object_costs(soup.objects, soup.options.cost);
    CellOptions options = soup.options;
    options.mesh = {};
    options.max_cells = 2;
    const std::span segments = std::span(soup.segments).first(200);
    const auto built = build_view_cells(soup.region, segments, soup.objects, options);
    // Every plane through an end of a segment clipped to the region, by definition.
    std::vector<std::pair<Vec3, Vec3>> clipped;
    for (const FreeSegment& free : segments) {
        const geometry::Interval inside = clip(free.segment, soup.region);
        const Vec3 step = free.segment.to - free.segment.from;
        clipped.emplace_back(free.segment.from + inside.min * step,
                             free.segment.from + inside.max * step);
    }
    double best = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t k = 0; k < 2 * clipped.size(); ++k) {
            const double x = (k % 2 == 0 ? clipped[k / 2].first : clipped[k / 2].second)[axis];
            std::set<ObjectId> behind, before, all;
            for (std::size_t i = 0; i < clipped.size(); ++i) {
                const auto [low, high] =
                    std::minmax({clipped[i].first[axis], clipped[i].second[axis]});
                for (const auto end : {segments[i].at_from, segments[i].at_to}) {
                    if (end == kNoTriangle) {
                        continue;
                    }
                    const ObjectId object = soup.objects.of(end);
                    all.insert(object);
                    if (low < x - 1e-8) {
                        behind.insert(object);
                    }
                    if (high > x + 1e-8) {
                        before.insert(object);
                    }
                }
            }
            const auto sum = [&](const std::set<ObjectId>& set) {
                double cost = 0.0;
                for (const ObjectId object : set) {
                    cost += costs[object];
                }
                return cost;
            };
            const double share = (x - soup.region.lower[axis]) / soup.region.size()[axis];
            best = std::max(best, sum(all) - share * sum(behind) - (1.0 - share) * sum(before));
        }
    }
    ASSERT_EQ(built.splits.size(), 1U);
    EXPECT_NEAR(built.splits[0].saving, best, 1e-6 * built.region_cost);
}

TEST(BuildViewCells, UsesPlanesOfTriangles) {
    // A wall across the corner: what is seen differs on its sides, and no axis fits.
    Room room = support::tessellated_box_room(Vec3(0.0), {4.0, 3.0, 4.0}, 12);
    const std::array<Vec3, 4> wall = {
        Vec3(0.0, 0.0, 4.0), Vec3(4.0, 0.0, 0.0), Vec3(4.0, 3.0, 0.0), Vec3(0.0, 3.0, 4.0)};
    const auto first = room.mesh.triangles.size();
    support::add_polygon(room, wall, 6, true);
    const ViewRegion region = {Vec3(0.0), {4.0, 3.0, 4.0}};
    const auto segments = sampled(room.mesh, region, 20000);
    const Objects objects = Objects::triangles(room.mesh.triangles.size());
    const CellOptions axes{.max_cells = 2};
    CellOptions all = axes;
    all.mesh = {room.mesh.positions, std::span(room.mesh.triangles).subspan(first)};
    const auto by_axes = build_view_cells(region, segments, objects, axes);
    const auto by_all = build_view_cells(region, segments, objects, all);
    const Vec3 expected = glm::normalize(Vec3(1.0, 0.0, 1.0));
    EXPECT_LT(glm::length(by_all.cells.nodes()[0].normal - expected), 1e-12);
    EXPECT_NEAR(by_all.cells.nodes()[0].offset, 4.0 * expected.x, 1e-12);
    EXPECT_GT(by_all.splits[0].saving, 1.5 * by_axes.splits[0].saving);
    EXPECT_NEAR(by_all.cells.volumes()[0], 24.0, 1e-12);
}

TEST(BuildViewCells, KeepsVolumeAndNeverIncreasesTheCost) {
    const Soup soup;
    const auto built = soup.build();
    ASSERT_EQ(built.cells.leaves(), 60U);
    double volume = 0.0;
    double fraction = 0.0;
    for (std::size_t leaf = 0; leaf < 60; ++leaf) {
        volume += built.cells.leaf_volumes()[leaf];
        fraction += built.viewer_fractions[leaf];
        EXPECT_GT(built.cells.leaf_volumes()[leaf], 0.0);
    }
    EXPECT_NEAR(volume, soup.region.volume(), 1e-9 * soup.region.volume());
    EXPECT_NEAR(fraction, 1.0, 1e-9);
    double cost = built.region_cost;
    for (const CellSplit& split : built.splits) {
        EXPECT_LE(split.cost, cost);
        EXPECT_NEAR(cost - split.cost, split.saving, 1e-6 * cost);
        cost = split.cost;
    }
    EXPECT_LT(cost, 0.8 * built.region_cost);
    EXPECT_NEAR(cost, cost_of(built, object_costs(soup.objects, soup.options.cost)), 1e-9 * cost);
    // Planes of triangles are among those taken.
    const auto nodes = built.cells.nodes();
    EXPECT_TRUE(std::any_of(nodes.begin(), nodes.end(), [](const CellNode& node) {
        return std::max({node.normal.x, node.normal.y, node.normal.z}) < 0.99;
    }));
}

TEST(BuildViewCells, KeepsVolumeInFlatRegionsAndFarAway) {
    // A soup squeezed flat, and a soup whose coordinates leave nine digits for what is in it.
    const std::array<std::pair<Vec3, Vec3>, 2> changes = {
        std::pair(Vec3(1.0, 1e-4, 1.0), Vec3(0.0)), std::pair(Vec3(1.0), Vec3(3e6, -5e6, 1e6))};
    for (const auto& [scale, shift] : changes) {
        Soup soup;
        for (Vec3& p : soup.mesh.positions) {
            p = scale * p + shift;
        }
        soup.region = {scale * soup.region.lower + shift, scale * soup.region.upper + shift};
        soup.segments = sampled(soup.mesh, soup.region, 6000);
        const auto built = soup.build();
        EXPECT_EQ(built.cells.leaves(), 60U);
        double volume = 0.0;
        for (const double part : built.cells.leaf_volumes()) {
            EXPECT_GT(part, 0.0);
            volume += part;
        }
        EXPECT_NEAR(volume, soup.region.volume(), 1e-9 * soup.region.volume());
        const auto shapes = leaf_shapes(built.cells);
        const double slack = 2.0 * plane_slack(soup.region);
        for (std::uint64_t i = 0; i < 1000; ++i) {
            const Vec3 part = test::random_point(kSeed, i, 0.0, 1.0);
            const Vec3 place = soup.region.lower + part * soup.region.size();
            ASSERT_TRUE(shapes[built.cells.leaf_at(place).value()].contains(place, slack))
                << "point " << i;
        }
    }
}

// The cell behind a wall gets no object of segments that end at the wall, once they are shortened.
TEST(BuildViewCells, PutsCellsAtWallsThatShortenedSegmentsDoNotReachThrough) {
    const Room room = rooms_with_door();
    ViewRegion region = kRooms;
    region.upper.y = 3.5;  // above the ceiling there is nothing
    const auto segments = sampled(room.mesh, kRooms, 20000);
    const Objects objects = Objects::triangles(room.mesh.triangles.size());
    CellOptions options{.max_cells = 30};
    options.mesh = room.mesh.view();
    const auto built = build_view_cells(region, segments, objects, options);
    const LeafId above = built.cells.leaf_at({8.0, 3.4, 2.0}).value();
    EXPECT_TRUE(built.sets[above].empty());
    std::vector<CellId> cells;
    for (const FreeSegment& free : segments) {
        built.cells.pierced(shortened(free.segment, plane_slack(region)), cells);
        EXPECT_FALSE(std::binary_search(cells.begin(), cells.end(), above));
    }
}

TEST(BuildViewCells, AlwaysSplitsTheLeafOfLargestSaving) {
    const auto built = Soup().build();
    // A leaf waits from the split that made it to the one that divides it; in between, none that
    // saves less is taken.
    const auto& splits = built.splits;
    for (std::size_t taken = 0; taken < splits.size(); ++taken) {
        for (std::size_t before = taken; before-- > 0;) {
            const LeafId leaf = splits[taken].leaf;
            if (splits[before].leaf == leaf || before + 1 == leaf) {
                break;  // here the leaf was made
            }
            EXPECT_GE(splits[before].saving, splits[taken].saving)
                << "splits " << before << " and " << taken;
        }
    }
}

TEST(BuildViewCells, LocatesPointsInTheLeafWhoseShapeContainsThem) {
    const Soup soup;
    const auto built = soup.build();
    const auto shapes = leaf_shapes(built.cells);
    for (std::size_t leaf = 0; leaf < shapes.size(); ++leaf) {
        EXPECT_NEAR(shapes[leaf].volume(), built.cells.leaf_volumes()[leaf], 1e-12);
    }
    for (std::uint64_t i = 0; i < 5000; ++i) {
        const Vec3 part = test::random_point(kSeed, i, 0.0, 1.0);
        const Vec3 place = soup.region.lower + part * soup.region.size();
        const LeafId leaf = built.cells.leaf_at(place).value();
        ASSERT_TRUE(shapes[leaf].contains(place, 1e-9)) << "point " << i;
    }
}

/// The length of a segment within a shape whose faces are moved outward, metres; negative if none.
double length_within(const CellShape& shape, const geometry::Segment& segment, double outward) {
    double begin = 0.0;
    double end = 1.0;
    for (const CellFace& face : shape.faces()) {
        const auto corner = [&](std::size_t i) { return shape.corners()[face.corners[i]]; };
        const Vec3 normal =
            glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
        const double from = glm::dot(normal, segment.from - corner(0)) - outward;
        const double to = glm::dot(normal, segment.to - corner(0)) - outward;
        if (from > 0.0 && to > 0.0) {
            return -1.0;
        }
        if (from > 0.0) {
            begin = std::max(begin, from / (from - to));
        } else if (to > 0.0) {
            end = std::min(end, from / (from - to));
        }
    }
    return (end - begin) * glm::length(segment.to - segment.from);
}

TEST(BuildViewCells, GivesEachLeafTheObjectsOfTheSegmentsThroughIt) {
    const Soup soup;
    const auto built = soup.build();
    const auto shapes = leaf_shapes(built.cells);
    std::size_t most = 0;
    std::size_t least = 0;
    for (std::size_t leaf = 0; leaf < built.sets.size(); ++leaf) {
        // Planes go through ends of segments: whether what just touches a leaf counts is open.
        std::set<ObjectId> touching, within;
        for (const FreeSegment& free : soup.segments) {
            const bool touches = length_within(shapes[leaf], free.segment, 1e-7) >= 0.0;
            const bool enters = length_within(shapes[leaf], free.segment, -1e-7) >= 0.0;
            for (const auto end : {free.at_from, free.at_to}) {
                if (end != kNoTriangle && touches) {
                    touching.insert(soup.objects.of(end));
                }
                if (end != kNoTriangle && enters) {
                    within.insert(soup.objects.of(end));
                }
            }
        }
        const auto& set = built.sets[leaf];
        EXPECT_TRUE(std::is_sorted(set.begin(), set.end()));
        EXPECT_TRUE(std::includes(touching.begin(), touching.end(), set.begin(), set.end()));
        EXPECT_TRUE(std::includes(set.begin(), set.end(), within.begin(), within.end()));
        most += touching.size();
        least += within.size();
    }
    EXPECT_LE(most, least + least / 10);
}

TEST(BuildViewCells, IsTheSameForAnyThreads) {
    Soup soup;
    soup.segments = sampled(soup.mesh, soup.region, 40000);
    const auto built = soup.build();
    for (const int threads : {2, 8}) {
        const auto other = soup.build(threads);
        EXPECT_EQ(built.cells, other.cells);
        EXPECT_EQ(built.sets, other.sets);
        EXPECT_EQ(built.splits, other.splits);
        EXPECT_EQ(built.viewer_fractions, other.viewer_fractions);
    }
}

TEST(BuildViewCells, FewerCellsAreThePrefixOfMore) {
    Soup soup;
    const auto more = soup.build();
    soup.options.max_cells = 20;
    const auto fewer = soup.build();
    EXPECT_TRUE(std::equal(fewer.splits.begin(), fewer.splits.end(), more.splits.begin()));
}

TEST(BuildViewCells, SplitsTheLargestLeafAtItsSpatialMedian) {
    CellOptions options{.rule = CellRule::middle, .max_cells = 8};
    const auto built = build_view_cells(kUnit, {}, Objects::triangles(0), options);
    ASSERT_EQ(built.cells.leaves(), 8U);
    for (const double volume : built.cells.leaf_volumes()) {
        EXPECT_DOUBLE_EQ(volume, 0.125);
    }
    std::set<LeafId> octants;
    for (int i = 0; i < 8; ++i) {
        octants.insert(
            built.cells.leaf_at({0.3 + 0.4 * (i % 2), 0.3 + 0.4 * (i / 2 % 2), 0.3 + 0.4 * (i / 4)})
                .value());
    }
    EXPECT_EQ(octants.size(), 8U);
}

TEST(BuildViewCells, WeightsByTheDensityOfViewers) {
    // Three times as many viewers in the left half; A is visible there, A, B and C in the right.
    const std::vector<FreeSegment> segments = {
        along_x(0.0, 0.5, 0), along_x(0.5, 1.0, 0), along_x(0.5, 1.0, 1), along_x(0.5, 1.0, 2)};
    CellOptions options{.max_cells = 2, .min_segments = 1};
    options.density = [](const Vec3& p) { return p.x < 0.5 ? 30.0 : 10.0; };
    const auto built = build_view_cells(kUnit, segments, Objects::triangles(3), options);
    // Points fill space evenly: of 65,536 some parts in ten thousand are on the wrong side.
    EXPECT_NEAR(built.region_cost, 3.0, 1e-12);
    ASSERT_EQ(built.splits.size(), 1U);
    EXPECT_EQ(built.cells.nodes()[0].offset, 0.5);
    EXPECT_NEAR(built.viewer_fractions[0], 0.75, 1e-3);
    EXPECT_NEAR(built.viewer_fractions[0] + built.viewer_fractions[1], 1.0, 1e-12);
    EXPECT_NEAR(built.splits[0].cost, 0.75 * 1.0 + 0.25 * 3.0, 2e-3);
    EXPECT_NEAR(built.splits[0].saving, 0.75 * 2.0, 2e-3);
}

TEST(BuildViewCells, StopsInBranchesWhereSplitsSaveLittle) {
    Soup soup;
    soup.options.min_saving = 1.0;  // more than any split
    soup.options.max_poor_splits = 2;
    EXPECT_EQ(soup.build().cells.leaves(), 4U);
    soup.options.max_poor_splits = 3;
    EXPECT_EQ(soup.build().cells.leaves(), 8U);
    soup.options.min_saving = 0.0;
    soup.options.min_segments = soup.segments.size() + 1;
    EXPECT_EQ(soup.build().cells.leaves(), 1U);
}

TEST(BuildViewCells, LeavesARegionWholeWhereNothingIsVisible) {
    const Objects none = Objects::triangles(0);
    for (const CellOptions& options : {CellOptions{}, CellOptions{.max_cells = 1}}) {
        const auto built = build_view_cells(kUnit, {}, none, options);
        EXPECT_EQ(built.cells, ViewCells(kUnit));
        EXPECT_EQ(built.region_cost, 0.0);
        EXPECT_TRUE(built.splits.empty());
        EXPECT_EQ(built.viewer_fractions, std::vector<double>{1.0});
    }
    // Segments beside the region, and such that end nowhere.
    const std::vector<FreeSegment> beside = {along_x(2.0, 3.0, 0), along_x(0.0, 1.0, kNoTriangle)};
    EXPECT_EQ(build_view_cells(kUnit, beside, Objects::triangles(1)).cells.leaves(), 1U);
}

TEST(BuildViewCells, RefusesInvalidOptions) {
    const Objects none = Objects::triangles(0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double far = std::numeric_limits<double>::infinity();
    for (const Vec3& upper : {Vec3(1.0, 0.0, 1.0),
                              Vec3(1.0, -1.0, -1.0),
                              Vec3(1.0, nan, 1.0),
                              Vec3(far, 1.0, 1.0),
                              Vec3(1e200)}) {
        EXPECT_THROW(build_view_cells({Vec3(0.0), upper}, {}, none), Error);
    }
    EXPECT_THROW(build_view_cells(kUnit, {}, none, {.max_cells = 0}), Error);
    EXPECT_THROW(build_view_cells(kUnit, {}, none, {.min_saving = nan}), Error);
    EXPECT_THROW(build_view_cells(kUnit, {}, none, {.max_poor_splits = 0}), Error);
    EXPECT_THROW(build_view_cells(kUnit, {}, none, {.cost = {-1.0, 1.0}}), Error);
    for (const double density : {0.0, -1.0, nan}) {
        CellOptions options;
        options.density = [density](const Vec3&) { return density; };
        EXPECT_THROW(build_view_cells(kUnit, {}, none, options), Error) << density;
    }
}

}  // namespace
}  // namespace earshot::visibility
