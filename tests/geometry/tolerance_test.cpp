// SPDX-License-Identifier: MIT
#include "earshot/geometry/tolerance.h"

#include <gtest/gtest.h>

#include <limits>

namespace earshot::geometry {
namespace {

TEST(CoplanarTolerance, IsFourUnitsInTheLastPlaceOfTheLargestCoordinate) {
    const Mesh mesh{{Vec3(0.0), Vec3(1.0, -8.0, 0.0), Vec3(0.0, 0.0, 3.0)}, {{0, 1, 2}}};
    const double ulp = static_cast<double>(std::numeric_limits<float>::epsilon()) * 8.0;
    EXPECT_EQ(coplanar_tolerance(mesh.view()), 4.0 * ulp);
}

TEST(CoplanarTolerance, IgnoresVerticesOfNoTriangle) {
    const Mesh mesh{{Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(1e9)}, {{0, 1, 2}}};
    EXPECT_LT(coplanar_tolerance(mesh.view()), 1e-6);
}

TEST(CoplanarTolerance, ScalesWithTheMesh) {
    Mesh mesh{{Vec3(0.1, 0.2, 0.3), Vec3(0.7, 0.0, 0.0), Vec3(0.0, 0.9, 0.0)}, {{0, 1, 2}}};
    const double before = coplanar_tolerance(mesh.view());
    for (Vec3& p : mesh.positions) {
        p *= 0x1p-30;
    }
    EXPECT_EQ(coplanar_tolerance(mesh.view()), before * 0x1p-30);
}

TEST(CoplanarTolerance, IsNeverZero) {
    EXPECT_GT(coplanar_tolerance({}), 0.0);
}

}  // namespace
}  // namespace earshot::geometry
