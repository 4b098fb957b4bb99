// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/relative_pose.h"

#include "earshot/base/error.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::collision {

using geometry::Vec3;

namespace {

// Far below what padding allows for, far above what composing rotations in doubles leaves.
constexpr double kRigidTolerance = 1e-9;

double max_abs_coordinate(const Vec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

bool is_rigid(const Pose& pose) noexcept {
    const glm::dmat3 product = glm::transpose(pose.rotation) * pose.rotation;
    double deviation = 0.0;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
            const double wrong = std::abs(product[i][k] - (i == k ? 1.0 : 0.0));
            deviation = wrong <= deviation ? deviation : wrong;
        }
    }
    return deviation <= kRigidTolerance && glm::determinant(pose.rotation) > 0.0 &&
           max_abs_coordinate(pose.translation) <= Shape::kMaxCoordinate;
}

void require_rigid(const Pose& pose) {
    if (!is_rigid(pose)) {
        throw Error("pose",
                    "is not a rotation, or a translation within 2^60 m",
                    "orthonormalise the rotation");
    }
}

namespace {

RelativeFrame frame_of(const glm::dmat3& rotation, const Vec3& origin, double padding) noexcept {
    RelativeFrame frame{};
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) {
            frame.rotation[k][j] = static_cast<float>(rotation[j][k]);
            frame.abs_rotation[k][j] = std::abs(frame.rotation[k][j]);
        }
        frame.translation[k] = static_cast<float>(origin[k]);
    }
    frame.padding = geometry::round_up(padding);
    return frame;
}

}  // namespace

RelativePose::RelativePose(const Body& a, const Body& b) {
    require_rigid(a.pose);
    require_rigid(b.pose);
    const glm::dmat3 a_back = glm::transpose(a.pose.rotation);
    const glm::dmat3 b_back = glm::transpose(b.pose.rotation);
    const glm::dmat3 rotation = a_back * b.pose.rotation;
    const Vec3 offset = b.pose.translation - a.pose.translation;
    // With u = 2^-24 and coordinates up to `max_coordinate` in either space: a box's centre in the
    // other space is off by at most 7 u max_coordinate (three products with rounded factors, three
    // sums), a centre offset by 9 u, its component along a rotated axis by 26 u, the projected
    // radii by 12 u; 64 u covers that. World positions are rounded to doubles.
    const double max_coordinate =
        2.0 * (a.shape.max_abs_coordinate() + b.shape.max_abs_coordinate()) +
        2.0 * max_abs_coordinate(offset);
    const double max_translation =
        max_abs_coordinate(a.pose.translation) + max_abs_coordinate(b.pose.translation);
    const double padding = 64.0 * 0x1p-24 * max_coordinate + 0x1p-48 * max_translation +
                           64.0 * static_cast<double>(std::numeric_limits<float>::min());
    b_in_a = frame_of(rotation, a_back * offset, padding);
    a_in_b = frame_of(glm::transpose(rotation), -(b_back * offset), padding);
    is_aligned = a.pose.rotation == b.pose.rotation;
}

}  // namespace earshot::collision
