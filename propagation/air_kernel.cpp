// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/air_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/propagation/air_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::propagation::HWY_NAMESPACE {

namespace lanes = earshot::HWY_NAMESPACE;
using lanes::Doubles;

// The operations of air_pressure().
HWY_INLINE Doubles pressure_of_loss(const double* rates, double distance) {
    const Doubles lost = Doubles(distance) * Doubles::load_unaligned(rates);
    return lanes::pow10(-lost / Doubles(20.0));
}

void pressures_of(std::span<const double> rates,
                  std::span<const double> distances,
                  std::span<double> factors) {
    double* out = factors.data();
    for (const double distance : distances) {
        for (std::size_t i = 0; i < rates.size(); i += Doubles::kCount) {
            pressure_of_loss(&rates[i], distance).store_unaligned(out);
            out += Doubles::kCount;
        }
    }
}

void pressures_of_all(const ArrivalRows& arrivals, std::span<double> pressures) {
    double* out = pressures.data();
    const std::uint8_t* sequence = arrivals.sequences.data();
    for (std::size_t i = 0; i < arrivals.lengths.size(); ++i) {
        const double length = arrivals.lengths[i];
        const std::size_t order = arrivals.orders[i];
        for (std::size_t k = 0; k < arrivals.stride; k += Doubles::kCount) {
            Doubles pressure = Doubles(1.0 / length);
            if (!arrivals.rates.empty()) {
                pressure = pressure * pressure_of_loss(&arrivals.rates[k], length);
            }
            const double* walls = &arrivals.walls[k];
            if (sequence == nullptr) {
                const Doubles wall = Doubles::load_unaligned(walls);
                for (std::size_t n = 0; n < order; ++n) {
                    pressure = pressure * wall;
                }
            } else {
                for (std::size_t n = 0; n < order; ++n) {
                    pressure =
                        pressure * Doubles::load_unaligned(walls + sequence[n] * arrivals.stride);
                }
            }
            pressure.store_unaligned(out);
            out += Doubles::kCount;
        }
        sequence = sequence == nullptr ? nullptr : sequence + order;
    }
}

}  // namespace earshot::propagation::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::propagation {

HWY_EXPORT(pressures_of);
HWY_EXPORT(pressures_of_all);

void pressures_of_losses(std::span<const double> rates,
                         std::span<const double> distances,
                         std::span<double> factors) noexcept {
    HWY_DYNAMIC_DISPATCH(pressures_of)(rates, distances, factors);
}

void pressures_of_arrivals(const ArrivalRows& arrivals, std::span<double> pressures) noexcept {
    HWY_DYNAMIC_DISPATCH(pressures_of_all)(arrivals, pressures);
}

}  // namespace earshot::propagation
#endif
