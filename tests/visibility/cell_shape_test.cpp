// SPDX-License-Identifier: MIT
#include "earshot/visibility/cell_shape.h"

#include "earshot/base/random.h"
#include "earshot/visibility/internal/volume_behind_plane.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/meshes.h"
#include <algorithm>
#include <cmath>

namespace earshot::visibility {
namespace {

using geometry::Vec3;

constexpr std::uint64_t kSeed = 17;
constexpr double kSlack = 1e-9;

const ViewRegion kBox = {{-1.0, 0.0, 2.0}, {5.0, 3.0, 12.0}};

Vec3 random_place(std::uint64_t index) {
    const Vec3 part = test::random_point(kSeed, index, 0.0, 1.0);
    return kBox.lower + part * kBox.size();
}

/// Through a random point of the box, any direction.
CellNode random_plane(std::uint64_t index) {
    const Vec3 normal = glm::normalize(test::random_point(kSeed + 1, index));
    return {normal, glm::dot(normal, random_place(index)), 0, 0};
}

double height(const CellNode& plane, const Vec3& point) {
    return glm::dot(plane.normal, point) - plane.offset;
}

/// Euler's number: corners - edges + faces.
int euler(const CellShape& shape) {
    std::size_t sides = 0;
    for (const CellFace& face : shape.faces()) {
        sides += face.corners.size();
    }
    return static_cast<int>(shape.corners().size()) - static_cast<int>(sides / 2) +
           static_cast<int>(shape.faces().size());
}

TEST(CellShape, BeginsAsABox) {
    const CellShape box(kBox);
    EXPECT_DOUBLE_EQ(box.volume(), 180.0);
    EXPECT_EQ(box.box(), kBox);
    EXPECT_EQ(box.faces().size(), 6U);
    EXPECT_EQ(euler(box), 2);
    EXPECT_TRUE(box.contains({0.0, 1.0, 3.0}));
    EXPECT_FALSE(box.contains({0.0, 1.0, 1.9}));
    EXPECT_TRUE(box.contains({0.0, 1.0, 1.9}, 0.11));
}

TEST(CellShape, SplitsIntoTheVolumesOfFormulas) {
    // A corner cut off a unit cube by x + y + z = 1 has the volume 1/6, and three planes' worth of
    // halves meet in one eighth.
    const CellShape cube({Vec3(0.0), Vec3(1.0)});
    const Vec3 diagonal = glm::normalize(Vec3(1.0));
    const auto corner = cube.split({diagonal, diagonal.x, 0, 0}, 7, kSlack);
    ASSERT_TRUE(corner);
    EXPECT_NEAR(corner->back.volume(), 1.0 / 6.0, 1e-15);
    EXPECT_NEAR(corner->front.volume(), 5.0 / 6.0, 1e-15);
    EXPECT_EQ(corner->back.faces().size(), 4U);
    EXPECT_EQ(corner->front.faces().size(), 7U);
    EXPECT_EQ(corner->back.faces().back().node, 7U);
    // Through opposite edges: corners lie on the plane.
    const Vec3 across = glm::normalize(Vec3(1.0, -1.0, 0.0));
    const auto wedges = cube.split({across, 0.0, 0, 0}, 0, kSlack);
    ASSERT_TRUE(wedges);
    EXPECT_NEAR(wedges->back.volume(), 0.5, 1e-15);
    EXPECT_EQ(wedges->back.corners().size(), 6U);
    EXPECT_EQ(wedges->back.faces().size(), 5U);
}

TEST(CellShape, IsNotSplitByPlanesThatMissOrTouchIt) {
    const CellShape cube({Vec3(0.0), Vec3(1.0)});
    const Vec3 x(1.0, 0.0, 0.0);
    const Vec3 diagonal = glm::normalize(Vec3(1.0));
    EXPECT_FALSE(cube.split({x, 2.0, 0, 0}, 0, kSlack));
    EXPECT_FALSE(cube.split({x, 1.0, 0, 0}, 0, kSlack));
    EXPECT_FALSE(cube.split({x, 0.5 * kSlack, 0, 0}, 0, kSlack));
    EXPECT_FALSE(cube.split({diagonal, 0.0, 0, 0}, 0, kSlack));
    EXPECT_FALSE(CellShape::empty().split({x, 0.5, 0, 0}, 0, kSlack));
}

TEST(CellShape, KeepsVolumeAndSidesThroughManySplits) {
    std::vector<CellShape> parts = {CellShape(kBox)};
    for (std::uint64_t i = 0; parts.size() < 400; ++i) {
        // Always the part with a random point.
        const Vec3 place = random_place(1000 + i);
        const auto part = std::find_if(parts.begin(), parts.end(), [&](const CellShape& shape) {
            return shape.contains(place, kSlack);
        });
        ASSERT_NE(part, parts.end()) << "cut " << i;
        CellNode plane = random_plane(i);
        plane.offset = glm::dot(plane.normal, place);
        auto halves = part->split(plane, 0, kSlack);
        if (!halves) {
            continue;
        }
        ASSERT_NEAR(halves->back.volume() + halves->front.volume(), part->volume(), 1e-11);
        for (const int side : {-1, 1}) {
            const CellShape& half = side < 0 ? halves->back : halves->front;
            ASSERT_EQ(euler(half), 2) << "cut " << i;
            ASSERT_GT(half.volume(), 0.0) << "cut " << i;
            for (const Vec3& corner : half.corners()) {
                ASSERT_GE(side * height(plane, corner), -2.0 * kSlack) << "cut " << i;
                ASSERT_TRUE(part->contains(corner, 1e-12)) << "cut " << i;
            }
        }
        *part = std::move(halves->back);
        parts.push_back(std::move(halves->front));
    }
    double sum = 0.0;
    for (const CellShape& part : parts) {
        sum += part.volume();
    }
    EXPECT_NEAR(sum, 180.0, 180.0 * 1e-12);
}

TEST(CellShape, OfALeafContainsThePointsLocatedThere) {
    const ViewCells cells = ViewCells::grid(kBox, {3, 2, 4});
    const auto shapes = leaf_shapes(cells);
    ASSERT_EQ(shapes.size(), 24U);
    for (std::size_t leaf = 0; leaf < shapes.size(); ++leaf) {
        EXPECT_NEAR(shapes[leaf].volume(), cells.leaf_volumes()[leaf], 1e-12);
    }
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const Vec3 place = random_place(i);
        EXPECT_TRUE(shapes[cells.leaf_at(place).value()].contains(place, kSlack)) << "point " << i;
    }
}

TEST(CellShape, OfLeavesThatPlanesOutsideMakeIsEmpty) {
    const Vec3 x(2.0, 0.0, 0.0);  // no unit normal: what counts is the plane
    const auto shapes =
        leaf_shapes(ViewCells(kBox, {{x, 20.0, kCellLeaf + 1, kCellLeaf}}, {0.0, 180.0}));
    EXPECT_TRUE(shapes[0].faces().empty());
    EXPECT_DOUBLE_EQ(shapes[1].volume(), 180.0);
}

TEST(VolumeBehindPlane, EqualsTheVolumeAfterSplitting) {
    CellLeaf leaf{.shape = CellShape(kBox)};
    for (std::uint64_t i = 0; i < 300; ++i) {
        leaf.shape = CellShape(kBox);
        for (std::uint64_t cut = 0; cut < 3; ++cut) {
            if (auto halves = leaf.shape.split(random_plane(10 * i + cut), 0, kSlack)) {
                leaf.shape = std::move(halves->back);
            }
        }
        leaf.volume = leaf.shape.volume();
        leaf.viewer_fraction = 0.5;
        const CellNode plane = random_plane(10 * i + 9);
        const auto halves = leaf.shape.split(plane, 0, kSlack);
        const double expected = halves ? halves->back.volume()
                                : height(plane, leaf.shape.vertex_mean()) < 0.0 ? leaf.volume
                                                                                : 0.0;
        const VolumeBehindPlane behind(leaf, {}, plane.normal);
        const double volume = behind.volume(plane.offset);
        ASSERT_NEAR(volume, expected, 1e-7) << "shape " << i;
        ASSERT_DOUBLE_EQ(behind.viewer_fraction(plane.offset, volume), 0.5 * volume / leaf.volume);
    }
}

TEST(VolumeBehindPlane, CountsViewersIfGiven) {
    const std::vector<Viewer> viewers = {
        {{0.0, 1.0, 3.0}, 0.25}, {{2.0, 1.0, 3.0}, 0.5}, {{1.0, 1.0, 3.0}, 0.125}};
    const CellLeaf leaf{.shape = CellShape(kBox), .volume = 180.0, .viewers = {0, 1, 2}};
    const VolumeBehindPlane behind(leaf, viewers, {1.0, 0.0, 0.0});
    EXPECT_EQ(behind.viewer_fraction(0.0, 30.0), 0.0);
    EXPECT_EQ(behind.viewer_fraction(0.5, 45.0), 0.25);
    EXPECT_EQ(behind.viewer_fraction(1.5, 75.0), 0.375);
    EXPECT_EQ(behind.viewer_fraction(4.0, 150.0), 0.875);
}

}  // namespace
}  // namespace earshot::visibility
