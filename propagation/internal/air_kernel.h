// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::propagation {

/// 10^(-distance rate / 20) for every distance (row) and rate (column). Precondition: a multiple of
/// 8 rates, distances.size() * rates.size() factors.
void pressures_of_losses(std::span<const double> rates,
                         std::span<const double> distances,
                         std::span<double> factors) noexcept;

/// Arrivals of which the walls are known.
struct ArrivalRows {
    std::size_t stride = 0;             ///< numbers of a row: a multiple of 8
    std::span<const double> lengths{};  ///< metres, per arrival
    std::span<const double> rates{};    ///< of the air, decibels per metre; empty: no absorption
    std::span<const double> walls{};    ///< pressure factors, a row per wall
    std::span<const std::uint8_t> orders{};  ///< reflections, per arrival
    /// The walls of all arrivals, one after another; empty: every one is the first.
    std::span<const std::uint8_t> sequences{};
};

/// A row per arrival: 1 / length, times the factors of the air and of its walls, in this order.
void pressures_of_arrivals(const ArrivalRows& arrivals, std::span<double> pressures) noexcept;

}  // namespace earshot::propagation
