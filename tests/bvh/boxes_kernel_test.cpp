// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/boxes_kernel.h"

#include "earshot/base/random.h"
#include "earshot/base/simd.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/intersect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace earshot::bvh {
namespace {

using geometry::Aabb;

/// Coordinates of both signs and all magnitudes, among them zeros, numbers that are floats, their
/// neighbours, and some beyond a float's range.
geometry::Mesh mesh_of_hard_numbers(std::size_t triangles) {
    geometry::Mesh mesh;
    const auto number = [](std::uint64_t i) {
        const double sign = random(1, 0, i) < 0.5 ? -1.0 : 1.0;
        const double mantissa = 1.0 + random(1, 1, i);
        const double magnitude =
            std::ldexp(mantissa, static_cast<int>(260.0 * random(1, 2, i)) - 131);
        const auto as_float = static_cast<double>(static_cast<float>(magnitude));
        switch (static_cast<int>(6.0 * random(1, 3, i))) {
            case 0:
                return 0.0;
            case 1:
                return -0.0;
            case 2:
                return sign * as_float;
            case 3:
                return sign * std::nextafter(as_float, 0.0);
            case 4:
                return sign * std::nextafter(as_float, 1e300);
            default:
                return sign * magnitude;
        }
    };
    for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
        mesh.positions.emplace_back(number(3 * i), number(3 * i + 1), number(3 * i + 2));
    }
    for (std::uint32_t i = 0; i < triangles; ++i) {
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

TEST(BoxesKernel, RoundsAsTheBoxOfOneTriangleOnEveryInstructionSet) {
    const geometry::Mesh mesh = mesh_of_hard_numbers(20000);
    std::vector<Aabb> expected;
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        const std::vector<Aabb> boxes = triangle_boxes(mesh.view());
        override_simd_target("auto");
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const auto [a, b, c] = geometry::corners(mesh.view(), i);
            ASSERT_EQ(boxes[i], geometry::triangle_box(a, b, c)) << target << ' ' << i;
        }
        expected = expected.empty() ? boxes : expected;
        EXPECT_EQ(std::memcmp(boxes.data(), expected.data(), boxes.size() * sizeof(Aabb)), 0)
            << target;
    }
}

TEST(BoxesKernel, UnitesBoxes) {
    const geometry::Mesh mesh = mesh_of_hard_numbers(1000);
    const std::vector<Aabb> boxes = triangle_boxes(mesh.view());
    std::vector<MortonPrimitive> primitives;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        primitives.push_back({0, (7 * i) % 1000});
    }
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        for (std::size_t count = 1; count <= 16; ++count) {
            for (std::size_t first = 0; first + count <= 1000; first += 31) {
                Aabb expected;
                for (std::size_t i = first; i < first + count; ++i) {
                    expected.include(boxes[primitives[i].index]);
                }
                EXPECT_EQ(united_box(boxes, std::span(primitives).subspan(first, count)), expected)
                    << target;
            }
        }
        override_simd_target("auto");
    }
}

}  // namespace
}  // namespace earshot::bvh
