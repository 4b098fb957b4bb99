// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace earshot::audio {

/// 10 / ln(10): decibels per unit of the natural logarithm of an energy.
inline constexpr double kDbPerLogEnergy = 4.342944819032518;

/// Sum of energies, and of their products with n - origin.
struct EnergyMoments {
    double energy = 0.0;
    double moment = 0.0;
};
EnergyMoments energy_moments(std::span<const double> energy, double origin);

/// Covariance of time and level, not divided by the count: the sum of (n - middle) log(energy[n]),
/// middle in the middle of the span. Precondition: energies > 0.
double log_covariance(std::span<const double> energy);

/// math::log() of each number. Precondition: logs.size() == numbers.size().
void natural_logs(std::span<const double> numbers, std::span<double> logs);

}  // namespace earshot::audio
