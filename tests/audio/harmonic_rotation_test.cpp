// SPDX-License-Identifier: MIT
#include "earshot/audio/harmonic_rotation.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace earshot::audio {
namespace {

using Vector = std::array<double, 3>;

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector unit(const Vector& v) {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
}

Vector random_direction(std::uint64_t stream) {
    Vector v{};
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
        v[axis] = random(5, stream, axis) - 0.5;
    }
    return unit(v);
}

RotationRows random_rows(std::uint64_t stream) {
    const Vector front = random_direction(3 * stream);
    const Vector left = unit(cross(random_direction(3 * stream + 1), front));
    return {front, left, cross(front, left)};
}

// A plane wave: its harmonics are those of its direction in the turned frame.
TEST(HarmonicRotation, TurnsPlaneWaves) {
    constexpr std::size_t kBlock = 8;
    for (int order = 0; order <= kMaxAmbisonicOrder; ++order) {
        const HarmonicRotation rotation(order);
        const std::size_t channels = rotation.channels();
        for (std::uint64_t trial = 0; trial < 20; ++trial) {
            const RotationRows rows = random_rows(trial);
            const Vector from = random_direction(1000 + trial);
            Vector turned{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                turned[axis] =
                    rows[axis][0] * from[0] + rows[axis][1] * from[1] + rows[axis][2] * from[2];
            }
            std::vector<double> before(channels), expected(channels);
            spherical_harmonics(order, from, before);
            spherical_harmonics(order, turned, expected);
            std::vector<float> matrix(rotation.coefficients());
            rotation.matrix(rows, matrix);
            std::vector<float> in(channels * kBlock), out(channels * kBlock);
            for (std::size_t k = 0; k < in.size(); ++k) {
                in[k] = static_cast<float>(before[k / kBlock]);
            }
            rotation.apply(matrix, matrix, kBlock, in.data(), out.data());
            for (std::size_t k = 0; k < out.size(); ++k) {
                ASSERT_NEAR(out[k], expected[k / kBlock], 2e-6) << order << ", " << k;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::audio
