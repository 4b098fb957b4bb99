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

double reach_of(const Vec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

void require_rigid(const Pose& pose) {
    const glm::dmat3 product = glm::transpose(pose.rotation) * pose.rotation;
    double deviation = 0.0;
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
            const double wrong = std::abs(product[i][k] - (i == k ? 1.0 : 0.0));
            deviation = wrong <= deviation ? deviation : wrong;
        }
    }
    if (!(deviation <= kRigidTolerance) || glm::determinant(pose.rotation) < 0.0 ||
        !(reach_of(pose.translation) <= Shape::kMaxCoordinate)) {
        throw Error("pose",
                    "is not a rotation, or a translation within 2^60 m",
                    "orthonormalise the rotation");
    }
}

namespace {

GuestFrame frame_of(const glm::dmat3& turn, const Vec3& origin, double padding) noexcept {
    GuestFrame frame{};
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) {
            frame.turn[k][j] = static_cast<float>(turn[j][k]);
            frame.magnitude[k][j] = std::abs(frame.turn[k][j]);
        }
        frame.origin[k] = static_cast<float>(origin[k]);
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
    const glm::dmat3 turn = a_back * b.pose.rotation;
    const Vec3 apart = b.pose.translation - a.pose.translation;
    // With u = 2^-24 and coordinates up to `reach` seen from either space: the guest's centre is
    // off by at most 7 u reach (three products with rounded factors, three sums), a difference of
    // centres by 9 u, its component along a turned axis by 26 u, the sides added to it by 12 u;
    // 64 u covers that. Positions in the world are rounded to doubles there.
    const double reach =
        2.0 * (a.shape.max_abs_coordinate() + b.shape.max_abs_coordinate()) + 2.0 * reach_of(apart);
    const double in_world = reach_of(a.pose.translation) + reach_of(b.pose.translation);
    const double padding = 64.0 * 0x1p-24 * reach + 0x1p-48 * in_world +
                           64.0 * static_cast<double>(std::numeric_limits<float>::min());
    b_in_a = frame_of(turn, a_back * apart, padding);
    a_in_b = frame_of(glm::transpose(turn), -(b_back * apart), padding);
    is_aligned = a.pose.rotation == b.pose.rotation;
}

}  // namespace earshot::collision
