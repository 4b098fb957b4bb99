// SPDX-License-Identifier: MIT
#include "earshot/audio/harmonic_rotation.h"

#include "earshot/audio/internal/arrival_mixing_kernel.h"
#include "earshot/audio/internal/spiral_directions.h"
#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::audio {

namespace {

constexpr std::size_t kMaxSide = 2 * static_cast<std::size_t>(kMaxAmbisonicOrder) + 1;
constexpr std::size_t kMaxChannels =
    static_cast<std::size_t>(kMaxAmbisonicOrder + 1) * (kMaxAmbisonicOrder + 1);
// Directions among which those of a degree are chosen.
constexpr std::size_t kCandidates = 200;

std::size_t side_of(int degree) {
    return 2 * static_cast<std::size_t>(degree) + 1;
}

/// Of a degree, into `values`.
void harmonics_of(int degree, const std::array<double, 3>& direction, double* values) {
    std::array<double, kMaxChannels> all{};
    spherical_harmonics(degree, direction, std::span(all).first(ambisonic_channels(degree)));
    const auto first = static_cast<std::ptrdiff_t>(degree) * degree;
    std::copy_n(all.begin() + first, side_of(degree), values);
}

/// As many directions as the degree has harmonics, whose harmonics are far from depending on each
/// other: again and again that with the largest remainder.
std::vector<std::array<double, 3>> independent_directions(int degree) {
    const std::size_t side = side_of(degree);
    const std::vector<std::array<double, 3>> all = spiral_directions(kCandidates);
    std::vector<std::array<double, kMaxSide>> rests(all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
        harmonics_of(degree, all[k], rests[k].data());
    }
    const auto dot = [](const auto& a, const auto& b) {
        double sum = 0.0;
        for (std::size_t m = 0; m < kMaxSide; ++m) {
            sum += a[m] * b[m];
        }
        return sum;
    };
    std::vector<std::array<double, 3>> chosen;
    while (chosen.size() < side) {
        std::size_t farthest = 0;
        for (std::size_t k = 1; k < all.size(); ++k) {
            if (dot(rests[k], rests[k]) > dot(rests[farthest], rests[farthest])) {
                farthest = k;
            }
        }
        chosen.push_back(all[farthest]);
        const std::array<double, kMaxSide> axis = rests[farthest];
        const double squared = dot(axis, axis);
        for (auto& rest : rests) {
            const double along = dot(rest, axis) / squared;
            for (std::size_t m = 0; m < kMaxSide; ++m) {
                rest[m] -= along * axis[m];
            }
        }
    }
    return chosen;
}

/// By Gauss and Jordan with pivots of the largest magnitude.
std::vector<double> inverse_of(std::vector<double> matrix, std::size_t side) {
    std::vector<double> inverse(side * side, 0.0);
    for (std::size_t i = 0; i < side; ++i) {
        inverse[i * side + i] = 1.0;
    }
    const auto swap_rows = [&](std::size_t a, std::size_t b) {
        for (std::size_t k = 0; k < side; ++k) {
            std::swap(matrix[a * side + k], matrix[b * side + k]);
            std::swap(inverse[a * side + k], inverse[b * side + k]);
        }
    };
    for (std::size_t column = 0; column < side; ++column) {
        std::size_t pivot = column;
        for (std::size_t row = column + 1; row < side; ++row) {
            if (std::abs(matrix[row * side + column]) > std::abs(matrix[pivot * side + column])) {
                pivot = row;
            }
        }
        swap_rows(column, pivot);
        const double scale = 1.0 / matrix[column * side + column];
        for (std::size_t k = 0; k < side; ++k) {
            matrix[column * side + k] *= scale;
            inverse[column * side + k] *= scale;
        }
        for (std::size_t row = 0; row < side; ++row) {
            const double factor = matrix[row * side + column];
            for (std::size_t k = 0; k < side && row != column; ++k) {
                matrix[row * side + k] -= factor * matrix[column * side + k];
                inverse[row * side + k] -= factor * inverse[column * side + k];
            }
        }
    }
    return inverse;
}

}  // namespace

HarmonicRotation::HarmonicRotation(int order) : order_(order) {
    EARSHOT_ASSERT(order >= 0 && order <= kMaxAmbisonicOrder);
    for (int degree = 0; degree <= order; ++degree) {
        const std::size_t side = side_of(degree);
        Degree of_degree{.directions = independent_directions(degree), .inverse = {}};
        // Column j: the harmonics of direction j.
        std::vector<double> values(side * side);
        std::array<double, kMaxSide> column{};
        for (std::size_t j = 0; j < side; ++j) {
            harmonics_of(degree, of_degree.directions[j], column.data());
            for (std::size_t m = 0; m < side; ++m) {
                values[m * side + j] = column[m];
            }
        }
        of_degree.inverse = inverse_of(std::move(values), side);
        degrees_.push_back(std::move(of_degree));
    }
}

std::size_t HarmonicRotation::coefficients() const noexcept {
    std::size_t count = 0;
    for (int degree = 0; degree <= order_; ++degree) {
        count += side_of(degree) * side_of(degree);
    }
    return count;
}

void HarmonicRotation::matrix(const RotationRows& rows,
                              std::span<float> coefficients) const noexcept {
    EARSHOT_ASSERT(coefficients.size() == this->coefficients());
    float* block = coefficients.data();
    for (int degree = 0; degree <= order_; ++degree) {
        const Degree& of_degree = degrees_[static_cast<std::size_t>(degree)];
        const std::size_t side = side_of(degree);
        // The harmonics of the turned directions, times the inverse of those before.
        std::array<double, kMaxSide * kMaxSide> turned{};
        for (std::size_t j = 0; j < side; ++j) {
            const std::array<double, 3>& d = of_degree.directions[j];
            std::array<double, 3> seen{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                seen[axis] = rows[axis][0] * d[0] + rows[axis][1] * d[1] + rows[axis][2] * d[2];
            }
            harmonics_of(degree, seen, &turned[j * side]);
        }
        for (std::size_t m = 0; m < side; ++m) {
            for (std::size_t k = 0; k < side; ++k) {
                double sum = 0.0;
                for (std::size_t j = 0; j < side; ++j) {
                    sum += turned[j * side + m] * of_degree.inverse[j * side + k];
                }
                block[m * side + k] = static_cast<float>(sum);
            }
        }
        block += side * side;
    }
}

void HarmonicRotation::apply(std::span<const float> from,
                             std::span<const float> to,
                             std::size_t block,
                             const float* in,
                             float* out) const noexcept {
    std::fill_n(out, channels() * block, 0.0F);
    std::array<float, kMaxSide> gains{}, steps{};
    const float per_sample = 1.0F / static_cast<float>(block);
    std::size_t first = 0;   // channel of the degree
    std::size_t offset = 0;  // of its block
    for (int degree = 0; degree <= order_; ++degree) {
        const std::size_t side = side_of(degree);
        for (std::size_t k = 0; k < side; ++k) {
            // Channel k of the degree goes to all channels of the degree.
            for (std::size_t m = 0; m < side; ++m) {
                const float begin = from[offset + m * side + k];
                gains[m] = begin;
                steps[m] = (to[offset + m * side + k] - begin) * per_sample;
            }
            add_to_channels(in + (first + k) * block,
                            block,
                            gains.data(),
                            steps.data(),
                            side,
                            block,
                            out + first * block);
        }
        first += side;
        offset += side * side;
    }
}

}  // namespace earshot::audio
