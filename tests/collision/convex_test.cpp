// SPDX-License-Identifier: MIT
#include "earshot/collision/convex.h"

#include "earshot/collision/discrete.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/box.h"
#include "support/dice.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::collision {
namespace {

using geometry::Mesh;
using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;
using support::Dice;

Mesh box(const Vec3& centre, const Vec3& half) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.push_back(centre + Vec3((i & 1) != 0 ? half.x : -half.x,
                                               (i & 2) != 0 ? half.y : -half.y,
                                               (i & 4) != 0 ? half.z : -half.z));
    }
    mesh.triangles = test::box_triangles();
    return mesh;
}

/// The hull of points in general position, by trying all triples: no code of the library.
Mesh hull_of(const std::vector<Vec3>& points) {
    Mesh mesh;
    mesh.positions = points;
    const auto n = static_cast<VertexId>(points.size());
    for (VertexId i = 0; i < n; ++i) {
        for (VertexId k = i + 1; k < n; ++k) {
            for (VertexId m = k + 1; m < n; ++m) {
                const Vec3 normal = glm::cross(points[k] - points[i], points[m] - points[i]);
                bool above = false, below = false;
                for (VertexId p = 0; p < n; ++p) {
                    if (p != i && p != k && p != m) {
                        const double height = glm::dot(normal, points[p] - points[i]);
                        above = above || height > 0.0;
                        below = below || height < 0.0;
                    }
                }
                if (!above) {
                    mesh.triangles.push_back({i, k, m});
                } else if (!below) {
                    mesh.triangles.push_back({i, m, k});
                }
            }
        }
    }
    return mesh;
}

/// Depth by its definition: how far the origin lies inside the hull of all differences of points of
/// a and b, whose faces are found by trying all triples; negative if it lies outside.
double depth_of_differences(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    std::vector<Vec3> points;
    for (const Vec3& p : a) {
        for (const Vec3& q : b) {
            points.push_back(p - q);
        }
    }
    double depth = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t k = i + 1; k < points.size(); ++k) {
            for (std::size_t m = k + 1; m < points.size(); ++m) {
                Vec3 normal = glm::cross(points[k] - points[i], points[m] - points[i]);
                const double length = glm::length(normal);
                if (length < 1e-9) {
                    continue;
                }
                normal /= length;
                bool above = false, below = false;
                for (std::size_t p = 0; p < points.size() && !(above && below); ++p) {
                    const double height = glm::dot(normal, points[p] - points[i]);
                    above = above || height > 1e-11;
                    below = below || height < -1e-11;
                }
                if (!(above && below)) {
                    const double origin = glm::dot(normal, points[i]);
                    depth = std::min(depth, above ? -origin : origin);
                }
            }
        }
    }
    return depth;
}

std::vector<Vec3> random_points(Dice& dice, int count, const Vec3& centre) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) {
        points.push_back(centre + Vec3(dice.between(-1.0, 1.0),
                                       dice.between(-1.0, 1.0),
                                       dice.between(-1.0, 1.0)));
    }
    return points;
}

/// The vertices that the hull uses, so that no unused point is in the oracle either.
std::vector<Vec3> used(const Mesh& mesh) {
    std::vector<Vec3> points;
    for (VertexId v = 0; v < mesh.positions.size(); ++v) {
        if (std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
                return t[0] == v || t[1] == v || t[2] == v;
            })) {
            points.push_back(mesh.positions[v]);
        }
    }
    return points;
}

std::optional<SolidDepth> depth_of(const Mesh& a, const Mesh& b) {
    const auto parts_a = convex_parts(a.view()), parts_b = convex_parts(b.view());
    EXPECT_EQ(parts_a.size(), 1U);
    EXPECT_EQ(parts_b.size(), 1U);
    return penetration_depth(parts_a, {}, parts_b, {});
}

TEST(ConvexDepth, OfCubesIsTheirSmallestOverlap) {
    // libccd issue 25: two cubes of 2 m, one 1.9 m above the other.
    const auto found = depth_of(box({0, 0, 0}, {1, 1, 1}), box({0, 0, 1.9}, {1, 1, 1}));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->depth, 0.1, 1e-15);
    EXPECT_NEAR(glm::length(found->move - Vec3(0, 0, -0.1)), 0.0, 1e-15);
    // One inside the other: out through the nearest side.
    const auto inside = depth_of(box({0.5, 0.1, 0}, {0.2, 0.2, 0.2}), box({0, 0, 0}, {1, 1, 1}));
    ASSERT_TRUE(inside);
    EXPECT_NEAR(inside->depth, 0.7, 1e-15);
    EXPECT_NEAR(inside->move.x, 0.7, 1e-15);
    EXPECT_EQ(depth_of(box({0, 0, 0}, {1, 1, 1}), box({2, 0.5, 0}, {1, 1, 1}))->depth, 0.0);
    EXPECT_FALSE(depth_of(box({0, 0, 0}, {1, 1, 1}), box({2.001, 0.5, 0}, {1, 1, 1})));
}

TEST(ConvexDepth, OfCrossedEdgesIsAlongTheirCrossProduct) {
    // Two wedges whose ridges cross at right angles, 0.25 m deep in each other.
    const auto wedge = [](double top, bool along_x, double sign) {
        Mesh mesh;
        for (const double s : {-4.0, 4.0}) {
            for (const Vec3& p : {Vec3(s, top, 0),
                                  Vec3(s, top - 4.0 * sign, -1.5),
                                  Vec3(s, top - 4.0 * sign, 1.5)}) {
                mesh.positions.push_back(along_x ? p : Vec3(p.z, p.y, p.x));
            }
        }
        mesh.triangles = {
            {0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
        return mesh;
    };
    const auto found = depth_of(wedge(0.25, true, 1.0), wedge(0.0, false, -1.0));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->depth, 0.25, 1e-15);
    EXPECT_NEAR(found->move.y, -0.25, 1e-15);
}

TEST(ConvexDepth, IsTheDistanceToTheHullOfDifferences) {
    Dice dice(7);
    int overlapping = 0;
    for (int round = 0; round < 60; ++round) {
        const Mesh a = hull_of(random_points(dice, 4 + round % 3, Vec3(0.0)));
        const Mesh b = hull_of(random_points(
            dice, 4 + round % 2, Vec3(dice.between(0.0, 1.2), dice.between(-0.3, 0.3), 0.2)));
        const double expected = depth_of_differences(used(a), used(b));
        const auto found = depth_of(a, b);
        ASSERT_EQ(found.has_value(), expected >= 0.0) << round;
        if (!found) {
            continue;
        }
        ++overlapping;
        EXPECT_NEAR(found->depth, expected, 1e-12) << round;
        EXPECT_NEAR(glm::length(found->move), found->depth, 1e-15) << round;
        // After the move they only touch; a little less leaves them overlapping.
        Mesh moved = a;
        for (Vec3& position : moved.positions) {
            position += (1.0 + 1e-9) * found->move;
        }
        EXPECT_FALSE(depth_of(moved, b)) << round;
        for (std::size_t i = 0; i < a.positions.size(); ++i) {
            moved.positions[i] = a.positions[i] + 0.5 * found->move;
        }
        EXPECT_NEAR(depth_of(moved, b)->depth, 0.5 * expected, 1e-12) << round;
        // The other way round the move is the opposite one.
        const auto other = depth_of(b, a);
        EXPECT_NEAR(other->depth, found->depth, 1e-12) << round;
    }
    EXPECT_GT(overlapping, 20);
}

TEST(ConvexDepth, DoesNotDependOnWherePartsStandOrHowTheyAreTurned) {
    Dice dice(9);
    const Mesh a = hull_of(random_points(dice, 12, Vec3(0.0)));
    const Mesh b = hull_of(random_points(dice, 12, Vec3(0.7, 0.2, 0.1)));
    const double expected = depth_of(a, b)->depth;
    const double c = std::cos(0.7), s = std::sin(0.7);
    const Pose pose{glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1), Vec3(1000.0, -500.0, 30.0)};
    const auto parts_a = convex_parts(a.view()), parts_b = convex_parts(b.view());
    const auto found = penetration_depth(parts_a, pose, parts_b, pose);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->depth, expected, 1e-12);
}

TEST(ConvexParts, AreClosedComponentsWithoutDents) {
    // Split into triangles of their own, as STL stores them; two cubes are two parts.
    Mesh two = box({0, 0, 0}, {1, 1, 1});
    const Mesh other = box({0.5, 0, 1.9}, {1, 1, 1});
    Mesh soup;
    for (const Mesh* mesh : {static_cast<const Mesh*>(&two), &other}) {
        for (const Triangle& t : mesh->triangles) {
            const auto first = static_cast<VertexId>(soup.positions.size());
            for (const VertexId v : t) {
                soup.positions.push_back(mesh->positions[v]);
            }
            soup.triangles.push_back({first, first + 1, first + 2});
        }
    }
    const auto parts = convex_parts(soup.view());
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].edges.size(), 12U);  // not the diagonals
    EXPECT_EQ(parts[0].vertices.size(), 8U);
    const auto depth = self_penetration_depth(parts, {});
    ASSERT_TRUE(depth);
    EXPECT_NEAR(depth->depth, 0.1, 1e-15);
    EXPECT_EQ(depth->part_a, 0U);
    EXPECT_EQ(depth->part_b, 1U);

    // Inside out is the same solid; with a hole, a dent or one face turned it is none.
    Mesh inside_out = box({0, 0, 0}, {1, 1, 1});
    for (Triangle& t : inside_out.triangles) {
        std::swap(t[0], t[1]);
    }
    EXPECT_NEAR(depth_of(inside_out, other)->depth, 0.1, 1e-15);
    Mesh open = box({0, 0, 0}, {1, 1, 1});
    open.triangles.pop_back();
    EXPECT_TRUE(convex_parts(open.view()).empty());
    Mesh turned = box({0, 0, 0}, {1, 1, 1});
    std::swap(turned.triangles[3][0], turned.triangles[3][1]);
    EXPECT_TRUE(convex_parts(turned.view()).empty());
    Mesh dented = box({0, 0, 0}, {1, 1, 1});
    dented.positions[7] *= 0.2;
    EXPECT_TRUE(convex_parts(dented.view()).empty());
    // What storing single precision does is no dent.
    Mesh rounded = box({0.1, 0.2, 0.3}, {1.0 / 3.0, 1.1, 0.7});
    const double c = std::cos(0.3), s = std::sin(0.3);
    for (Vec3& p : rounded.positions) {
        p = Vec3(glm::vec3(c * p.x - s * p.y, s * p.x + c * p.y, p.z));
    }
    EXPECT_EQ(convex_parts(rounded.view()).size(), 1U);
    EXPECT_TRUE(convex_parts({}).empty());
    EXPECT_FALSE(penetration_depth(std::vector<ConvexPart>{}, {}, parts, {}));
}

}  // namespace
}  // namespace earshot::collision
