// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/packed_rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace earshot::propagation {

namespace {

using Quaternion = std::array<double, 4>;  // w, x, y, z

constexpr int kBits = 20;
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
constexpr double kLargest = 0.70710678118654752;           // of a component that is not the largest
constexpr double kSteps = static_cast<double>(kMask / 2);  // from 0 to kLargest: 0 is kept

/// Shepperd 1978: from the largest of the four squares.
Quaternion quaternion_of(const audio::RotationRows& r) {
    const std::array<double, 4> squares = {1.0 + r[0][0] + r[1][1] + r[2][2],
                                           1.0 + r[0][0] - r[1][1] - r[2][2],
                                           1.0 - r[0][0] + r[1][1] - r[2][2],
                                           1.0 - r[0][0] - r[1][1] + r[2][2]};
    const auto largest = static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) -
                                                  squares.begin());
    const double twice = std::sqrt(std::max(squares[largest], 0.0));
    const double f = twice > 0.0 ? 0.5 / twice : 0.0;
    const double x = (r[2][1] - r[1][2]) * f;
    const double y = (r[0][2] - r[2][0]) * f;
    const double z = (r[1][0] - r[0][1]) * f;
    const double xy = (r[0][1] + r[1][0]) * f;
    const double xz = (r[0][2] + r[2][0]) * f;
    const double yz = (r[1][2] + r[2][1]) * f;
    switch (largest) {
        case 0:
            return {0.5 * twice, x, y, z};
        case 1:
            return {x, 0.5 * twice, xy, xz};
        case 2:
            return {y, xy, 0.5 * twice, yz};
        default:
            return {z, xz, yz, 0.5 * twice};
    }
}

}  // namespace

std::uint64_t pack_rotation(const Pose& pose) noexcept {
    const Pose still{};
    audio::RotationRows rows{};
    const std::array<geometry::Vec3, 3> axes = {pose.front, pose.left, pose.up};
    for (std::size_t row = 0; row < 3; ++row) {
        const geometry::Vec3 seen = still.seen_from(axes[row]);
        rows[row] = {seen.x, seen.y, seen.z};
    }
    const Quaternion q = quaternion_of(rows);
    std::size_t largest = 0;
    for (std::size_t i = 1; i < 4; ++i) {
        largest = std::abs(q[i]) > std::abs(q[largest]) ? i : largest;
    }
    const double sign = q[largest] < 0.0 ? -1.0 : 1.0;
    std::uint64_t packed = largest;
    for (std::size_t i = 0; i < 4; ++i) {
        if (i != largest) {
            const double share = std::clamp(sign * q[i] / kLargest, -1.0, 1.0);
            const double step = std::floor(share * kSteps + 0.5) + kSteps;
            packed = packed << kBits | static_cast<std::uint64_t>(step);
        }
    }
    return packed;
}

audio::RotationRows unpack_rotation(std::uint64_t packed) noexcept {
    Quaternion q{};
    const auto largest = static_cast<std::size_t>(packed >> (3 * kBits));
    double rest = 1.0;
    for (std::size_t i = 4; i-- > 0;) {
        if (i != largest) {
            q[i] = (static_cast<double>(packed & kMask) - kSteps) / kSteps * kLargest;
            rest -= q[i] * q[i];
            packed >>= kBits;
        }
    }
    q[largest] = std::sqrt(std::max(rest, 0.0));
    const auto [w, x, y, z] = q;
    return {{{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
             {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
             {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}}};
}

}  // namespace earshot::propagation
