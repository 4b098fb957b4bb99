// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/decay_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/decay_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/audio/kernels/eight_sums-inl.h"
#include "earshot/base/simd/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

HWY_INLINE Eight log_of_eight(const Eight& numbers) {
    return per_part<Eight>([&](std::size_t i) {
        Doubles part;
        part.part[0] = numbers.part[i];
        return log(part).part[0];
    });
}

EnergyMoments moments(const double* energy, std::size_t count, double origin) {
    Eight sum(0.0);
    Eight moment(0.0);
    const Eight lanes = lane_numbers();
    for_each_eight(energy, count, 0.0, [&](Eight e, std::size_t n) {
        sum = sum + e;
        moment = moment + e * ((lanes + Eight(static_cast<double>(n))) - Eight(origin));
    });
    return {total(sum), total(moment)};
}

double covariance(const double* energy, std::size_t count) {
    const Eight middle(0.5 * (static_cast<double>(count) - 1.0));
    Eight sum(0.0);
    const Eight lanes = lane_numbers();
    // The logarithm of 1 adds nothing.
    for_each_eight(energy, count, 1.0, [&](Eight e, std::size_t n) {
        sum = sum + ((lanes + Eight(static_cast<double>(n))) - middle) * log_of_eight(e);
    });
    return total(sum);
}

void logs_of(const double* numbers, std::size_t count, double* logs) {
    for_each_eight(numbers, count, 1.0, [&](Eight x, std::size_t n) {
        alignas(64) double result[8];
        log_of_eight(x).store(result);
        std::copy(result, result + std::min<std::size_t>(8, count - n), logs + n);
    });
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(moments);
HWY_EXPORT(covariance);
HWY_EXPORT(logs_of);

EnergyMoments energy_moments(std::span<const double> energy, double origin) {
    return HWY_DYNAMIC_DISPATCH(moments)(energy.data(), energy.size(), origin);
}

double log_covariance(std::span<const double> energy) {
    return HWY_DYNAMIC_DISPATCH(covariance)(energy.data(), energy.size());
}

void natural_logs(std::span<const double> numbers, std::span<double> logs) {
    HWY_DYNAMIC_DISPATCH(logs_of)(numbers.data(), numbers.size(), logs.data());
}

}  // namespace earshot::audio
#endif
