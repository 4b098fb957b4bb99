// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/occluders.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "group_scenes.h"
#include "line_of_sight_scenes.h"
#include "support/dice.h"
#include <algorithm>
#include <cmath>
#include <vector>

namespace earshot::visibility {
namespace {

using geometry::Aabb;
using geometry::Mesh;
using geometry::Segment;
using geometry::Vec3;
using support::Dice;

/// A sheet of cells over a parallelogram, some of them left out; vertices are shared exactly, by
/// number or by position, and lie a little off the plane.
Mesh random_sheet(Dice& dice, const Placement& placement) {
    const Vec3 corner = placement.point(dice);
    const Vec3 u = placement.point(dice) - corner;
    const Vec3 v = placement.point(dice) - corner;
    const int columns = 1 + dice.below(3), rows = 1 + dice.below(3);
    const double bump = dice.chance(0.5) ? 0.0 : 1e-9 * placement.scale;
    const bool shares_vertices = dice.chance(0.5);
    std::vector<Vec3> grid;
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            grid.push_back(corner + (static_cast<double>(column) / columns) * u +
                           (static_cast<double>(row) / rows) * v +
                           Vec3(dice.between(-bump, bump), dice.between(-bump, bump), 0.0));
        }
    }
    Mesh mesh;
    const auto add = [&](int a, int b, int c) {
        const auto first = static_cast<geometry::VertexId>(mesh.positions.size());
        for (const int index : {a, b, c}) {
            mesh.positions.push_back(grid[static_cast<std::size_t>(index)]);
        }
        if (dice.chance(0.5)) {
            mesh.triangles.push_back({first, first + 1, first + 2});
        } else {
            mesh.triangles.push_back({first + 1, first, first + 2});
        }
    };
    const double missing = shares_vertices ? 0.0 : 0.15;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const int a = row * (columns + 1) + column;
            const int b = a + 1, c = a + columns + 1, d = c + 1;
            if (!dice.chance(missing)) {
                add(a, b, c);
            }
            if (!dice.chance(missing)) {
                add(b, d, c);
            }
        }
    }
    if (mesh.triangles.empty()) {
        add(0, 1, columns + 1);
    }
    return mesh;
}

bool blocked_by_brute_force(const Mesh& mesh, const Segment& segment) {
    return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
        return geometry::touches(
            segment, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
    });
}

/// A box behind a point of the sheet as seen from the viewer, or behind a point of its border and
/// off it by next to nothing: where a bound that is too weak would be found out.
Aabb box_behind(Dice& dice, const Mesh& mesh, const Vec3& viewer, const Placement& placement) {
    const auto& triangle = mesh.triangles[static_cast<std::size_t>(
        dice.below(static_cast<int>(mesh.triangles.size())))];
    const Vec3 a = mesh.positions[triangle[0]], b = mesh.positions[triangle[1]],
               c = mesh.positions[triangle[2]];
    double x = dice.between(0.0, 1.0), y = dice.between(0.0, 1.0);
    if (dice.chance(0.5)) {
        const double next_to_nothing = std::pow(10.0, dice.between(-17.0, -2.0));
        (dice.chance(0.5) ? x : y) = dice.chance(0.5) ? next_to_nothing : -next_to_nothing;
    }
    if (x + y > 1.0) {
        x = 1.0 - x;
        y = 1.0 - y;
    }
    const Vec3 through = a + x * (b - a) + y * (c - a);
    const double behind = 1.0 + std::pow(10.0, dice.between(-9.0, 0.0));
    const Vec3 middle = viewer + behind * (through - viewer);
    const double half =
        dice.chance(0.3) ? 0.0 : std::pow(10.0, dice.between(-15.0, -1.0)) * placement.scale;
    Aabb box;
    box.include(middle - Vec3(half));
    box.include(middle + Vec3(half));
    return box;
}

/// Attacks the decision with `cases` random ones: what is hidden is blocked for every viewer of the
/// region and every point of the box.
void attack(int cases, std::uint64_t seed) {
    Dice dice(seed);
    int by_triangle = 0, by_patch = 0;
    for (int i = 0; i < cases; ++i) {
        const Placement placement = random_placement(dice);
        const Mesh mesh = random_sheet(dice, placement);
        const Occluders occluders(mesh.view(), {});
        const ViewerRegion viewer = random_region(dice, placement);
        const Aabb box = box_behind(dice, mesh, random_viewer(dice, viewer), placement);
        std::vector<Occluders::Id> ids;
        for (geometry::TriangleId id = 0; id < mesh.triangles.size(); ++id) {
            ids.push_back(id);
            ids.push_back(occluders.of_triangle(id));
        }
        std::sort(ids.begin(), ids.end());
        ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
        for (const Occluders::Id id : ids) {
            if (!occluders.hides(mesh.view(), id, viewer, box)) {
                continue;
            }
            (id < mesh.triangles.size() ? by_triangle : by_patch) += 1;
            for (int line = 0; line < 24; ++line) {
                const Segment segment{random_viewer(dice, viewer), random_point(dice, box)};
                if (id < mesh.triangles.size()) {
                    ASSERT_TRUE(blocks(mesh.view(), id, segment)) << i << ", seed " << seed;
                } else {
                    ASSERT_TRUE(blocked_by_brute_force(mesh, segment)) << i << ", seed " << seed;
                }
            }
        }
    }
    EXPECT_GT(by_triangle, cases / 20);
    EXPECT_GT(by_patch, cases / 20);
}

TEST(Occluders, HideOnlyWhatIsBlocked) {
    attack(6000, 3);
}

TEST(Occluders, HideOnlyWhatIsBlockedSlow) {
    for (std::uint64_t seed = 100; seed < 110; ++seed) {
        attack(20000, seed);
    }
}

Mesh wall_with_door() {
    // Four by four cells of a metre, two of them missing, at z = 0.
    Mesh mesh;
    for (int y = 0; y <= 4; ++y) {
        for (int x = 0; x <= 4; ++x) {
            mesh.positions.emplace_back(x, y, 0.0);
        }
    }
    for (geometry::VertexId y = 0; y < 4; ++y) {
        for (geometry::VertexId x = 0; x < 4; ++x) {
            if (x == 1 && y < 2) {
                continue;
            }
            const geometry::VertexId a = 5 * y + x;
            mesh.triangles.push_back({a, a + 1, a + 5});
            mesh.triangles.push_back({a + 1, a + 6, a + 5});
        }
    }
    return mesh;
}

Aabb box_about(const Vec3& centre, double half) {
    Aabb box;
    box.include(centre - Vec3(half));
    box.include(centre + Vec3(half));
    return box;
}

TEST(Occluders, AWallHidesAsAWholeButNotThroughItsDoor) {
    const Mesh mesh = wall_with_door();
    const Occluders occluders(mesh.view(), {});
    ASSERT_EQ(occluders.patch_count(), 1U);
    const Occluders::Id wall = occluders.of_triangle(0);
    EXPECT_GE(wall, mesh.triangles.size());
    const ViewerRegion viewer(Vec3(2.5, 2.5, 3.0), Vec3(2.6, 2.6, 3.0), 0.05);
    // Beside the door, over the joints of eight triangles.
    EXPECT_TRUE(occluders.hides(mesh.view(), wall, viewer, box_about({2.9, 3.0, -0.5}, 0.4)));
    EXPECT_FALSE(occluders.hides(mesh.view(), 0, viewer, box_about({2.9, 3.0, -0.5}, 0.4)));
    // Behind the door, in front of the wall, beside the wall.
    EXPECT_FALSE(occluders.hides(mesh.view(), wall, viewer, box_about({1.4, 0.8, -0.5}, 0.1)));
    EXPECT_FALSE(occluders.hides(mesh.view(), wall, viewer, box_about({2.9, 3.0, 0.5}, 0.3)));
    EXPECT_FALSE(occluders.hides(mesh.view(), wall, viewer, box_about({4.6, 3.0, -0.1}, 0.3)));
}

TEST(Occluders, PatchesEndWhereTrianglesAreExcludedOrMove) {
    const Mesh mesh = wall_with_door();
    ExclusionMask mask;
    const geometry::TriangleId removed = 20;
    mask.add(removed);
    const Occluders without(mesh.view(), mask);
    const Vec3 middle =
        (mesh.positions[mesh.triangles[removed][0]] + mesh.positions[mesh.triangles[removed][1]] +
         mesh.positions[mesh.triangles[removed][2]]) /
        3.0;
    const ViewerRegion viewer(middle + Vec3(0, 0, 2));
    const Aabb box = box_about(middle - Vec3(0, 0, 0.5), 1e-3);
    const Occluders whole(mesh.view(), {});
    EXPECT_TRUE(whole.hides(mesh.view(), whole.of_triangle(removed), viewer, box));
    EXPECT_FALSE(without.hides(mesh.view(), without.of_triangle(0), viewer, box));

    Occluders moving(mesh.view(), {});
    const Occluders::Id wall = moving.of_triangle(0);
    std::vector<std::uint8_t> moved(mesh.triangles.size(), 0);
    moved[3] = 1;
    moving.remove_moved_patches(moved);
    EXPECT_FALSE(moving.hides(mesh.view(), wall, viewer, box));
    EXPECT_EQ(moving.of_triangle(removed), removed);
}

}  // namespace
}  // namespace earshot::visibility
