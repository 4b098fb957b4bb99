// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/delay_line_kernel.h"

#include "earshot/audio/internal/fractional_delay.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/delay_line_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/audio/kernels/eight_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

void read_between(const double* signal,
                  const double* rows,
                  const double* positions,
                  std::size_t count,
                  double* values) {
    constexpr double kFractions = static_cast<double>(kDelayFractions);
    for (std::size_t n = 0; n < count; ++n) {
        const auto whole = static_cast<std::size_t>(positions[n]);
        const double place = (positions[n] - static_cast<double>(whole)) * kFractions;
        const auto below = static_cast<std::size_t>(place);
        const double along = place - static_cast<double>(below);
        const double* low = rows + below * kDelayTaps;
        const double* high = low + kDelayTaps;
        const double* samples = signal + whole - (kDelayHalfLength - 1);
        Eight of_low(0.0);
        Eight of_high(0.0);
        for (std::size_t tap = 0; tap < kDelayTaps; tap += 8) {
            const Eight sample = Eight::load_unaligned(samples + tap);
            of_low = of_low + Eight::load_unaligned(low + tap) * sample;
            of_high = of_high + Eight::load_unaligned(high + tap) * sample;
        }
        values[n] = (1.0 - along) * total(of_low) + along * total(of_high);
    }
}

void add_ramp(const double* values, std::size_t count, double gain, double step, double* sum) {
    const Eight lanes = lane_numbers();
    std::size_t n = 0;
    for (; n + 8 <= count; n += 8) {
        const Eight gains = Eight(gain) + (lanes + Eight(static_cast<double>(n))) * Eight(step);
        (Eight::load_unaligned(sum + n) + gains * Eight::load_unaligned(values + n))
            .store_unaligned(sum + n);
    }
    for (; n < count; ++n) {
        sum[n] += (gain + static_cast<double>(n) * step) * values[n];
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(read_between);
HWY_EXPORT(add_ramp);

void read_between(const double* signal,
                  const double* rows,
                  const double* positions,
                  std::size_t count,
                  double* values) {
    HWY_DYNAMIC_DISPATCH(read_between)(signal, rows, positions, count, values);
}

void add_ramp(const double* values, std::size_t count, double gain, double step, double* sum) {
    HWY_DYNAMIC_DISPATCH(add_ramp)(values, count, gain, step, sum);
}

}  // namespace earshot::audio
#endif
