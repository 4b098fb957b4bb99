// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/air_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/propagation/air_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::propagation::HWY_NAMESPACE {

// The operations of air_pressure().
void pressures_of(std::span<const double> rates,
                  std::span<const double> distances,
                  std::span<double> factors) {
    namespace lanes = earshot::HWY_NAMESPACE;
    using lanes::Doubles;
    double* out = factors.data();
    for (const double distance : distances) {
        for (std::size_t i = 0; i < rates.size(); i += Doubles::kCount) {
            const Doubles lost = Doubles(distance) * Doubles::load_unaligned(&rates[i]);
            lanes::pow10(-lost / Doubles(20.0)).store_unaligned(out);
            out += Doubles::kCount;
        }
    }
}

}  // namespace earshot::propagation::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::propagation {

HWY_EXPORT(pressures_of);

void pressures_of_losses(std::span<const double> rates,
                         std::span<const double> distances,
                         std::span<double> factors) noexcept {
    HWY_DYNAMIC_DISPATCH(pressures_of)(rates, distances, factors);
}

}  // namespace earshot::propagation
#endif
