// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace earshot::propagation {

/// 10^(-distance rate / 20) for every distance (row) and rate (column). Precondition: a multiple of
/// 8 rates, distances.size() * rates.size() factors.
void pressures_of_losses(std::span<const double> rates,
                         std::span<const double> distances,
                         std::span<double> factors) noexcept;

}  // namespace earshot::propagation
