// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/arrival_mixing_kernel.h"

#include "earshot/audio/internal/short_delay.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/arrival_mixing_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/audio/kernels/eight_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

namespace {

HWY_INLINE Float8 float_lane_numbers() {
    alignas(32) constexpr float kNumbers[8] = {0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F};
    return Float8::load(kNumbers);
}

}  // namespace

void mix_signals(const ChunkRing& ring,
                 std::size_t first,
                 std::size_t chunks,
                 const SignalWeight* weights,
                 std::size_t count,
                 float origin,
                 float* out) {
    const Float8 lanes = float_lane_numbers();
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        const float* numbers =
            ring.numbers + ((first + chunk) & ring.mask) * ring.signals * kLineChunk;
        Float8 constant[2] = {Float8(0.0F), Float8(0.0F)};
        Float8 slope[2] = {Float8(0.0F), Float8(0.0F)};
        for (std::size_t i = 0; i < count; ++i) {
            const float* signal = numbers + weights[i].signal * kLineChunk;
            const Float8 weight(weights[i].weight);
            const Float8 step(weights[i].step);
            for (std::size_t half = 0; half < 2; ++half) {
                const Float8 samples = Float8::load(signal + 8 * half);
                constant[half] = constant[half] + weight * samples;
                slope[half] = slope[half] + step * samples;
            }
        }
        for (std::size_t half = 0; half < 2; ++half) {
            const auto begin = static_cast<float>(chunk * kLineChunk + 8 * half);
            const Float8 along = lanes + Float8(begin - origin);
            (constant[half] + along * slope[half]).store(out + chunk * kLineChunk + 8 * half);
        }
    }
}

void read_delayed(const float* signal,
                  const float* rows,
                  double begin,
                  const DelayPolynomial& delay,
                  double distance_per_sample,
                  double min_distance,
                  std::size_t count,
                  float* values) {
    constexpr double kFractions = static_cast<double>(kShortDelayFractions);
    alignas(64) double positions[8], levels[8];
    alignas(64) float sums[8][8];
    const Eight lanes = lane_numbers();
    for (std::size_t n = 0; n < count; n += 8) {
        // Where the samples come from, and the level of the distance.
        const Eight at = lanes + Eight(static_cast<double>(n));
        const Eight late =
            Eight(delay.constant) +
            at * (Eight(delay.linear) + at * (Eight(delay.square) + at * Eight(delay.cube)));
        (Eight(begin) + at - late).store(positions);
        (Eight(1.0) / max(late * Eight(distance_per_sample), Eight(min_distance))).store(levels);
        // Eight products of a row of the table and the signal, not yet summed.
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const auto whole = static_cast<std::int64_t>(positions[lane]);
            const double place = (positions[lane] - static_cast<double>(whole)) * kFractions;
            const auto below = static_cast<std::int64_t>(place);
            const Float8 along(static_cast<float>(place - static_cast<double>(below)));
            const float* low = rows + below * static_cast<std::int64_t>(kShortDelayTaps);
            const float* samples = signal + whole - static_cast<std::int64_t>(kShortDelayLead);
            Float8 of_low(0.0F);
            Float8 of_high(0.0F);
            for (std::size_t tap = 0; tap < kShortDelayTaps; tap += 8) {
                const Float8 sample = Float8::load_unaligned(samples + tap);
                of_low = of_low + Float8::load(low + tap) * sample;
                of_high = of_high + Float8::load(low + kShortDelayTaps + tap) * sample;
            }
            (of_low + along * (of_high - of_low)).store(sums[lane]);
        }
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const float* s = sums[lane];
            const float sum = ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
            values[n + lane] = sum * static_cast<float>(levels[lane]);
        }
    }
}

void add_to_channels(const float* values,
                     std::size_t count,
                     const float* gains,
                     const float* steps,
                     std::size_t channels,
                     std::size_t stride,
                     float* out) {
    const Float8 lanes = float_lane_numbers();
    for (std::size_t n = 0; n < count; n += 8) {
        const Float8 value = Float8::load_unaligned(values + n);
        const Float8 along = (lanes + Float8(static_cast<float>(n))) * value;
        for (std::size_t channel = 0; channel < channels; ++channel) {
            float* sum = out + channel * stride + n;
            const Float8 added = Float8(gains[channel]) * value + Float8(steps[channel]) * along;
            (Float8::load_unaligned(sum) + added).store_unaligned(sum);
        }
    }
}

namespace {

/// kParts products at once, so that the sum is read and written once for all of them.
template <std::size_t kParts>
HWY_INLINE void add_some_products(const float* a, const float* b, std::size_t count, float* sum) {
    const std::size_t row = 2 * count;
    for (std::size_t n = 0; n < count; n += 8) {
        Float8 re = Float8::load(sum + n);
        Float8 im = Float8::load(sum + count + n);
        for (std::size_t part = 0; part < kParts; ++part) {
            const std::size_t place = part * row + n;
            const Float8 a_re = Float8::load(a + place);
            const Float8 a_im = Float8::load(a + place + count);
            const Float8 b_re = Float8::load(b + place);
            const Float8 b_im = Float8::load(b + place + count);
            re = re + (a_re * b_re - a_im * b_im);
            im = im + (a_re * b_im + a_im * b_re);
        }
        re.store(sum + n);
        im.store(sum + count + n);
    }
}

}  // namespace

void add_complex_products(
    const float* a, const float* b, std::size_t parts, std::size_t count, float* sum) {
    constexpr std::size_t kAtOnce = 4;
    const std::size_t row = 2 * count;
    std::size_t part = 0;
    for (; part + kAtOnce <= parts; part += kAtOnce) {
        add_some_products<kAtOnce>(a + part * row, b + part * row, count, sum);
    }
    for (; part < parts; ++part) {
        add_some_products<1>(a + part * row, b + part * row, count, sum);
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(mix_signals);
HWY_EXPORT(read_delayed);
HWY_EXPORT(add_to_channels);
HWY_EXPORT(add_complex_products);

void mix_signals(const ChunkRing& ring,
                 std::size_t first,
                 std::size_t chunks,
                 const SignalWeight* weights,
                 std::size_t count,
                 float origin,
                 float* out) {
    HWY_DYNAMIC_DISPATCH(mix_signals)(ring, first, chunks, weights, count, origin, out);
}

void read_delayed(const float* signal,
                  const float* rows,
                  double begin,
                  const DelayPolynomial& delay,
                  double distance_per_sample,
                  double min_distance,
                  std::size_t count,
                  float* values) {
    HWY_DYNAMIC_DISPATCH(read_delayed)
    (signal, rows, begin, delay, distance_per_sample, min_distance, count, values);
}

void add_to_channels(const float* values,
                     std::size_t count,
                     const float* gains,
                     const float* steps,
                     std::size_t channels,
                     std::size_t stride,
                     float* out) {
    HWY_DYNAMIC_DISPATCH(add_to_channels)(values, count, gains, steps, channels, stride, out);
}

void add_complex_products(
    const float* a, const float* b, std::size_t parts, std::size_t count, float* sum) {
    HWY_DYNAMIC_DISPATCH(add_complex_products)(a, b, parts, count, sum);
}

}  // namespace earshot::audio
#endif
