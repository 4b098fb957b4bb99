// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/band_gain_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/band_gain_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

/// At k = 0 the ratio is 0, its inverse infinite and the gain 0.
template <typename Row>
HWY_INLINE Row power_gain(const BandGainOptions& options, Row k) {
    const Row frequency_hz = Row(options.sample_rate) * k / Row(options.size);
    const Row ratio = frequency_hz / Row(options.centre_hz);
    const Row x = (ratio - Row(1.0) / ratio) / Row(options.width);
    const Row x_squared = x * x;
    return Row(1.0) / (Row(1.0) + x_squared * x_squared * x_squared);
}

void power_gains(const BandGainOptions& options, double* gains, std::size_t count) {
    constexpr std::size_t kStep = Doubles::kCount;
    alignas(64) double index[kStep];
    for (std::size_t i = 0; i < kStep; ++i) {
        index[i] = static_cast<double>(i);
    }
    const Doubles lane = Doubles::load(index);
    std::size_t k = 0;
    for (; k + kStep <= count; k += kStep) {
        power_gain(options, lane + Doubles(static_cast<double>(k))).store_unaligned(gains + k);
    }
    using One = Lanes<double, 1>;
    for (; k < count; ++k) {
        power_gain(options, One(static_cast<double>(k))).store_unaligned(gains + k);
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(power_gains);

void compute_power_gains(const BandGainOptions& options, std::span<double> gains) {
    HWY_DYNAMIC_DISPATCH(power_gains)(options, gains.data(), gains.size());
}

}  // namespace earshot::audio
#endif
