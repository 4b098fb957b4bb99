// SPDX-License-Identifier: MIT
#include "earshot/bvh/exact_coordinates.h"

#include "earshot/base/random.h"
#include "earshot/bvh/brute_force.h"
#include "earshot/bvh/internal/float_ray.h"
#include "earshot/bvh/partial_refit.h"
#include "earshot/bvh/wide_ray.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>

namespace earshot::bvh {
namespace {

using geometry::Mesh;
using geometry::Ray;
using geometry::Vec3;

Mesh with_coordinates(Mesh mesh, const std::function<double(double)>& coordinate) {
    for (Vec3& position : mesh.positions) {
        for (int axis = 0; axis < 3; ++axis) {
            position[axis] = coordinate(position[axis]);
        }
    }
    return mesh;
}

double to_single(double value) {
    return static_cast<double>(static_cast<float>(value));
}

/// What a reader finds where a writer printed so many digits.
double printed(double value, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return std::strtod(text, nullptr);
}

WideTree wide_tree_of(const Mesh& mesh, LeafEncoding encoding = LeafEncoding::single) {
    return WideTree::build(
        Tree::build(triangle_boxes(mesh.view())), mesh.view(), Executor::serial(), encoding);
}

bool restores(const ExactCoordinates& exact, const Mesh& mesh) {
    for (const Vec3& position : mesh.positions) {
        for (int axis = 0; axis < 3; ++axis) {
            const double restored = exact.restore(static_cast<float>(position[axis]));
            if (std::bit_cast<std::uint64_t>(restored) !=
                std::bit_cast<std::uint64_t>(position[axis])) {
                return false;
            }
        }
    }
    return true;
}

/// Rays at corners, edges and insides of triangles.
void expect_equal_answers(const Mesh& mesh, const WideTree& tree, const std::string& what) {
    for (std::uint64_t i = 0; i < 300; ++i) {
        const auto [a, b, c] =
            geometry::corners(mesh, random_bits(8, 5, i) % mesh.triangles.size());
        const std::array<Vec3, 3> targets = {a, 0.5 * (a + b), (a + b + c) / 3.0};
        const Vec3 origin = 3.0 * test::random_point(9, i);
        const Ray ray = {origin, targets[i % 3] - origin};
        ASSERT_EQ(closest_hit(tree, mesh.view(), ray), brute_force::closest_hit(mesh.view(), ray))
            << what << ", ray " << i;
    }
}

TEST(ExactCoordinates, HoldForSinglePrecisionAndForDecimalNumbers) {
    const Mesh general = test::triangle_soup(1, 400);
    const Mesh single = with_coordinates(general, to_single);
    EXPECT_EQ(wide_tree_of(single).exact_coordinates(), ExactCoordinates::single());
    expect_equal_answers(single, wide_tree_of(single), "single");
    for (int digits = 0; digits <= 5; ++digits) {
        const Mesh decimal =
            with_coordinates(general, [&](double value) { return printed(value, digits); });
        const WideTree tree = wide_tree_of(decimal);
        ASSERT_TRUE(tree.exact_coordinates().are_known()) << digits;
        EXPECT_TRUE(restores(tree.exact_coordinates(), decimal)) << digits;
        expect_equal_answers(decimal, tree, std::to_string(digits) + " digits");
    }
}

TEST(ExactCoordinates, HoldForLargeAndSmallDecimalNumbers) {
    const Mesh general = test::triangle_soup(2, 400);
    for (int power = -6; power <= 5; ++power) {
        const double size = std::pow(10.0, power);
        const Mesh decimal = with_coordinates(
            general, [&](double value) { return printed(size * value, 5 - power); });
        const ExactCoordinates exact = wide_tree_of(decimal).exact_coordinates();
        ASSERT_TRUE(exact.are_known()) << power;
        EXPECT_TRUE(restores(exact, decimal)) << power;
    }
}

TEST(ExactCoordinates, KeepTheSignOfZero) {
    Mesh mesh = with_coordinates(test::triangle_soup(3, 40),
                                 [](double value) { return printed(value, 4); });
    mesh.positions[7].y = -0.0;
    mesh.positions[8].y = 0.0;
    const ExactCoordinates exact = wide_tree_of(mesh).exact_coordinates();
    ASSERT_TRUE(exact.are_known());
    EXPECT_TRUE(restores(exact, mesh));
}

// One coordinate beside the rule is enough: the last bit, or a number that single precision loses.
TEST(ExactCoordinates, AreNotKnownWhereOneCoordinateIsOff) {
    const Mesh single = with_coordinates(test::triangle_soup(4, 400), to_single);
    const Mesh decimal = with_coordinates(test::triangle_soup(4, 400),
                                          [](double value) { return printed(value, 5); });
    EXPECT_FALSE(wide_tree_of(single, LeafEncoding::quantised).exact_coordinates().are_known());
    for (const Mesh& exact : {single, decimal}) {
        for (const double off : {std::nextafter(exact.positions[500].x, 9.0), 1e-300, -1e-60}) {
            Mesh mesh = exact;
            mesh.positions[500].x = off;
            EXPECT_FALSE(wide_tree_of(mesh).exact_coordinates().are_known()) << off;
            expect_equal_answers(mesh, wide_tree_of(mesh), "off");
        }
    }
}

TEST(ExactCoordinates, HoldBesideWhatIsNotANumber) {
    Mesh mesh = with_coordinates(test::triangle_soup(7, 40), to_single);
    mesh.positions[50].x = std::numeric_limits<double>::quiet_NaN();
    expect_equal_answers(mesh, wide_tree_of(mesh), "not a number");
}

TEST(ExactCoordinates, FollowARefit) {
    const Mesh rest = with_coordinates(test::triangle_soup(5, 400), to_single);
    const Mesh moved = with_coordinates(rest, [](double value) { return value / 3.0; });
    const Mesh decimal = with_coordinates(rest, [](double value) { return printed(value, 5); });
    WideTree tree = wide_tree_of(rest);
    for (const Mesh& mesh : {moved, decimal, rest, moved}) {
        tree.refit(mesh.view());
        EXPECT_EQ(tree.exact_coordinates(), wide_tree_of(mesh).exact_coordinates());
        expect_equal_answers(mesh, tree, "refit");
    }
}

TEST(ExactCoordinates, FollowAPartialRefit) {
    Mesh mesh = with_coordinates(test::triangle_soup(6, 400), to_single);
    WideTree tree = wide_tree_of(mesh);
    PartialRefit places(tree);
    const std::vector<TriangleRange> range = {{100, 102}};
    const geometry::VertexId vertex = mesh.triangles[101][2];
    for (const double x : {0.25, 1.0 / 3.0, 0.5}) {
        mesh.positions[vertex].x = x;
        places.refit(tree, mesh.view(), range);
        // Once a leaf is not exact, nothing is known until all leaves are packed again.
        EXPECT_EQ(tree.exact_coordinates().are_known(), x == 0.25) << x;
        expect_equal_answers(mesh, tree, "partial refit");
    }
}

// Of the two terms of the bound each is needed: the product for normal numbers, the sum for smaller
// ones.
TEST(FloatBeyond, IsNotBelowAndHardlyAbove) {
    int below_without_product = 0, below_without_sum = 0;
    for (std::uint64_t i = 0; i < 200000; ++i) {
        const double exponent = std::floor(-160.0 + 290.0 * random(11, 1, i));
        const double t = i == 0 ? 0.0 : std::exp2(exponent) * (1.0 + random(11, 2, i));
        const double bound = float_beyond(t);
        ASSERT_GE(bound, t) << i;
        if (t < 0x1p127) {
            ASSERT_LE(bound, (1.0 + 0x1p-21) * t + 0x1p-125) << i;
        }
        const auto rounded = static_cast<float>(t);
        below_without_product += static_cast<double>(rounded + 0x1p-126F) < t ? 1 : 0;
        below_without_sum += static_cast<double>(rounded * (1.0F + 0x1p-22F)) < t ? 1 : 0;
    }
    EXPECT_GT(below_without_product, 0);
    EXPECT_GT(below_without_sum, 0);
    EXPECT_EQ(float_beyond(1e300), std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace earshot::bvh
