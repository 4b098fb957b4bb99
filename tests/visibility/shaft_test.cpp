// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/shaft.h"

#include "earshot/geometry/intersect.h"

#include <gtest/gtest.h>

#include "group_scenes.h"
#include "support/dice.h"

namespace earshot::visibility {
namespace {

using geometry::Aabb;
using geometry::Corners;
using geometry::Segment;
using geometry::Vec3;
using support::Dice;

// A triangle that some line of sight from the region to the box touches is never outside of the
// shaft: triangles through a point of such a line, by a corner, an edge or their middle, at any
// scale and far from the origin.
TEST(Shaft, HoldsWhatLinesOfSightTouch) {
    Dice dice(11);
    int outside = 0, touched = 0;
    for (int i = 0; i < 20000; ++i) {
        const Placement placement = random_placement(dice);
        const ViewerRegion viewer = random_region(dice, placement);
        const Aabb box = random_box(dice, placement);
        const Shaft shaft(viewer, box, placement.max_abs_coordinate());
        const Segment line{random_viewer(dice, viewer), random_point(dice, box)};
        const Vec3 on_line = line.from + dice.between(0.0, 1.0) * (line.to - line.from);
        Corners triangle{placement.point(dice), placement.point(dice), placement.point(dice)};
        switch (dice.below(4)) {
            case 0:
                triangle[0] = on_line;
                break;
            case 1:
                triangle[1] = 2.0 * on_line - triangle[0];
                break;
            case 2:
                triangle[2] = 3.0 * on_line - triangle[0] - triangle[1];
                break;
            default:
                break;
        }
        const bool may_touch = shaft.may_touch(triangle);
        const bool touches = geometry::touches(line, triangle[0], triangle[1], triangle[2]);
        ASSERT_TRUE(may_touch || !touches) << i;
        const Aabb around = geometry::triangle_box(triangle[0], triangle[1], triangle[2]);
        ASSERT_TRUE(shaft.may_touch(around) || !may_touch) << i;
        outside += may_touch ? 0 : 1;
        touched += touches ? 1 : 0;
    }
    EXPECT_GT(outside, 1000);
    EXPECT_GT(touched, 3000);
}

// What lies beside a slanted shaft is told apart from it, although it is in its box.
TEST(Shaft, IsTightAlongTheDiagonal) {
    Aabb box;
    box.include(Vec3(9.0));
    box.include(Vec3(10.0));
    const Shaft shaft(ViewerRegion(Vec3(0.0)), box, 20.0);
    EXPECT_FALSE(shaft.may_touch(Corners{Vec3(7, 2, 2), Vec3(8, 2, 2), Vec3(8, 3, 2)}));
    EXPECT_TRUE(shaft.may_touch(Corners{Vec3(5, 5, 4), Vec3(6, 5, 5), Vec3(4, 5, 6)}));
    Aabb beside;
    beside.include(Vec3(7, 2, 2));
    beside.include(Vec3(8, 3, 3));
    EXPECT_FALSE(shaft.may_touch(beside));
    // Its corners are on different sides of the shaft, but its plane leaves it aside.
    EXPECT_FALSE(shaft.may_touch(Corners{Vec3(30, 0, 0), Vec3(0, 40, 0), Vec3(0, 0, 45)}));
}

}  // namespace
}  // namespace earshot::visibility
