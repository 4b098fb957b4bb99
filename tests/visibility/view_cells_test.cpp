// SPDX-License-Identifier: MIT
#include "earshot/visibility/view_cells.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace earshot::visibility {
namespace {

using geometry::Segment;
using geometry::Vec3;

constexpr std::uint64_t kSeed = 3;

const ViewRegion kHall = {{-1.0, 0.0, 2.0}, {5.0, 3.0, 12.0}};
constexpr std::array<std::uint32_t, 3> kCounts = {4, 3, 5};

Vec3 random_point(std::uint64_t index, double margin = 0.0) {
    Vec3 point(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = random_between(kSeed,
                                     static_cast<std::uint64_t>(axis),
                                     index,
                                     kHall.lower[axis] - margin,
                                     kHall.upper[axis] + margin);
    }
    return point;
}

CellId box_of(const Vec3& point) {
    std::array<CellId, 3> place{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        place[k] = static_cast<CellId>((point[axis] - kHall.lower[axis]) /
                                       (kHall.upper[axis] - kHall.lower[axis]) * kCounts[k]);
    }
    return (place[2] * kCounts[1] + place[1]) * kCounts[0] + place[0];
}

TEST(ViewCells, OneCellIsTheRegion) {
    const ViewCells cells(kHall);
    EXPECT_EQ(cells.size(), 1U);
    EXPECT_EQ(cells.cell_at({0.0, 1.0, 3.0}), CellId{0});
    EXPECT_EQ(cells.cell_at(kHall.lower), CellId{0});
    EXPECT_EQ(cells.cell_at(kHall.upper), CellId{0});
    EXPECT_FALSE(cells.cell_at({0.0, 1.0, 1.9}));
    EXPECT_DOUBLE_EQ(cells.volumes()[0], 180.0);
}

TEST(ViewCells, GridsAreEqualBoxesInOrder) {
    const ViewCells cells = ViewCells::grid(kHall, kCounts);
    ASSERT_EQ(cells.size(), 60U);
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const Vec3 point = random_point(i);
        ASSERT_EQ(cells.cell_at(point), box_of(point)) << "point " << i;
    }
    for (const double volume : cells.volumes()) {
        EXPECT_DOUBLE_EQ(volume, 3.0);
    }
}

TEST(ViewCells, SegmentsPierceTheCellsOfTheirPoints) {
    const ViewCells cells = ViewCells::grid(kHall, kCounts);
    std::vector<CellId> pierced;
    for (std::uint64_t i = 0; i < 500; ++i) {
        const Segment segment = {random_point(2 * i, 2.0), random_point(2 * i + 1, 2.0)};
        cells.pierced(segment, pierced);
        ASSERT_TRUE(std::is_sorted(pierced.begin(), pierced.end(), std::less_equal<>()) ||
                    pierced.size() < 2);
        // Each cell that points lie in is there, and what is there has points near it.
        std::vector<CellId> sampled;
        for (int k = 0; k <= 5000; ++k) {
            const Vec3 point = segment.from + k / 5000.0 * (segment.to - segment.from);
            if (const auto cell = cells.cell_at(point)) {
                sampled.push_back(*cell);
            }
        }
        std::sort(sampled.begin(), sampled.end());
        sampled.erase(std::unique(sampled.begin(), sampled.end()), sampled.end());
        ASSERT_TRUE(std::includes(pierced.begin(), pierced.end(), sampled.begin(), sampled.end()))
            << "segment " << i;
        // Between samples, which are some millimetres apart, a corner may be cut.
        ASSERT_LE(pierced.size(), sampled.size() + 2) << "segment " << i;
    }
}

TEST(ViewCells, SegmentsThatMissTheRegionPierceNothing) {
    std::vector<CellId> pierced = {7};
    ViewCells::grid(kHall, kCounts).pierced({{-3.0, 0.0, 0.0}, {-2.0, 5.0, 20.0}}, pierced);
    EXPECT_TRUE(pierced.empty());
}

TEST(ViewCells, PlanesMayBeObliqueAndBelongToTheirFront) {
    // x + z = 4 cuts the region into two wedges.
    const ViewCells cells(kHall, {{{1.0, 0.0, 1.0}, 4.0, kCellLeaf + 1, kCellLeaf}}, {2.0, 1.0});
    EXPECT_EQ(cells.cell_at({0.0, 1.0, 3.9}), CellId{1});
    EXPECT_EQ(cells.cell_at({0.0, 1.0, 4.0}), CellId{0});
    EXPECT_EQ(cells.cell_at({2.0, 1.0, 2.0}), CellId{0});
}

TEST(ViewCells, MergedLeavesAreOneCell) {
    const ViewCells cells =
        ViewCells::grid({{0.0, 0.0, 0.0}, {4.0, 1.0, 1.0}}, {4, 1, 1}).merged({1, 0, 1, 1});
    EXPECT_EQ(cells.size(), 2U);
    EXPECT_EQ(cells.cell_at({0.5, 0.5, 0.5}), CellId{1});
    EXPECT_EQ(cells.cell_at({1.5, 0.5, 0.5}), CellId{0});
    EXPECT_DOUBLE_EQ(cells.volumes()[1], 3.0);
    std::vector<CellId> pierced;
    cells.pierced({{-1.0, 0.5, 0.5}, {5.0, 0.5, 0.5}}, pierced);
    EXPECT_EQ(pierced, (std::vector<CellId>{0, 1}));
}

TEST(ViewCells, RefusesInvalidTrees) {
    const Vec3 x(1.0, 0.0, 0.0);
    EXPECT_THROW(ViewCells(kHall, {}, {}), Error);
    EXPECT_THROW(ViewCells(kHall, {{x, 1.0, kCellLeaf, kCellLeaf}}, {1.0, 1.0}), Error);
    EXPECT_THROW(ViewCells(kHall, {{x, 1.0, kCellLeaf, kCellLeaf + 2}}, {1.0, 1.0}), Error);
    EXPECT_THROW(ViewCells(kHall, {{x, 1.0, 0, kCellLeaf}}, {1.0, 1.0}), Error);
    EXPECT_THROW(ViewCells::grid(kHall, {0, 1, 1}), Error);
    EXPECT_THROW(ViewCells::grid(kHall, {1U << 31U, 1U << 31U, 1U << 31U}), Error);
    EXPECT_THROW(ViewCells::grid(kHall, {2, 1, 1}).merged({0}), Error);
    EXPECT_THROW(ViewCells::grid(kHall, {2, 1, 1}).merged({0, 2}), Error);
    EXPECT_THROW(ViewCells::grid(kHall, {2, 1, 1}).merged({1, 1}), Error);
}

TEST(ViewCells, RefusesRegionsThatAreUpsideDownOrNotFinite) {
    constexpr double kMaxDouble = std::numeric_limits<double>::max();
    constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
    for (const ViewRegion& region :
         {ViewRegion{{1.0, 1.0, 1.0}, {0.0, 0.0, 0.0}},
          ViewRegion{{0.0, 1.0, 0.0}, {1.0, 0.0, 1.0}},
          ViewRegion{Vec3(-kMaxDouble), Vec3(kMaxDouble)},
          ViewRegion{Vec3(0.0), {1.0, kNoNumber, 1.0}},
          ViewRegion{Vec3(-kMaxDouble), {-kMaxDouble, -kMaxDouble, kMaxDouble}}}) {
        EXPECT_THROW(ViewCells{region}, Error);
        EXPECT_THROW(ViewCells::grid(region, {2, 2, 2}), Error);
    }
    EXPECT_EQ(ViewCells::grid({Vec3(1.0), Vec3(1.0)}, {2, 1, 1}).cell_at(Vec3(1.0)), CellId{1});
}

}  // namespace
}  // namespace earshot::visibility
