// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace earshot::audio {

inline constexpr std::size_t kModulationBands = 7;

/// Sums of energy[n] cos(angle n) and energy[n] sin(angle n).
struct FourierSum {
    double in_phase = 0.0;
    double in_quadrature = 0.0;
};

/// Of rows of equal length, a multiple of 8. `angle`: radians, of size below 1e4 / the length.
std::array<FourierSum, kModulationBands> fourier_sums(
    const std::array<const double*, kModulationBands>& energy, std::size_t length, double angle);

inline constexpr std::size_t kSumRow = 32;

/// Adds to `sums` rows of kSumRow numbers, each row times a factor, in their order.
/// Precondition: rows.size() == factors.size() * kSumRow.
void add_rows(std::span<const double> rows,
              std::span<const double> factors,
              std::span<double, kSumRow> sums);

}  // namespace earshot::audio
