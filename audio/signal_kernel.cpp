// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/signal_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/signal_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

void add_product(const double* a, const double* b, std::size_t count, double* sum) {
    for (std::size_t k = 0; k < count; k += Doubles::kCount) {
        const ComplexDoubles u = ComplexDoubles::load_unaligned(a + 2 * k);
        const ComplexDoubles v = ComplexDoubles::load_unaligned(b + 2 * k);
        const ComplexDoubles s = ComplexDoubles::load_unaligned(sum + 2 * k);
        const ComplexDoubles total{s.re + (u.re * v.re - u.im * v.im),
                                   s.im + (u.re * v.im + u.im * v.re)};
        total.store_unaligned(sum + 2 * k);
    }
}

void add_scaled(double factor, const double* values, std::size_t count, double* sum) {
    const std::size_t whole = count / Doubles::kCount * Doubles::kCount;
    const Doubles factors(factor);
    for (std::size_t n = 0; n < whole; n += Doubles::kCount) {
        const Doubles more = factors * Doubles::load_unaligned(values + n);
        (Doubles::load_unaligned(sum + n) + more).store_unaligned(sum + n);
    }
    for (std::size_t n = whole; n < count; ++n) {
        sum[n] += factor * values[n];
    }
}

void interpolate(
    const double* low, const double* high, double along, std::size_t count, double* values) {
    const Doubles of_low(1.0 - along);
    const Doubles of_high(along);
    for (std::size_t n = 0; n < count; n += Doubles::kCount) {
        const Doubles value =
            of_low * Doubles::load_unaligned(low + n) + of_high * Doubles::load_unaligned(high + n);
        value.store_unaligned(values + n);
    }
}

void spread(const double* taps,
            std::size_t tap_count,
            const double* weights,
            std::size_t train_count,
            std::size_t stride,
            double* trains) {
    const std::size_t whole = tap_count / Doubles::kCount * Doubles::kCount;
    for (std::size_t m = 0; m < train_count; ++m) {
        double* train = trains + m * stride;
        const Doubles weight(weights[m]);
        for (std::size_t n = 0; n < whole; n += Doubles::kCount) {
            const Doubles more = weight * Doubles::load_unaligned(taps + n);
            (Doubles::load_unaligned(train + n) + more).store_unaligned(train + n);
        }
        for (std::size_t n = whole; n < tap_count; ++n) {
            train[n] += weights[m] * taps[n];
        }
    }
}

/// kConvolutionMargin sums or fewer from `first` on.
HWY_INLINE void add_to_block(double factor,
                             const double* samples,
                             std::size_t count,
                             const double* taps,
                             std::size_t tap_count,
                             std::size_t first,
                             std::size_t sums,
                             double* sum) {
    // Of the block's sums, taps[first - n + i] is the tap of sum i of sample n; the margins are the
    // taps of sums that the sample does not reach.
    constexpr std::size_t kParts = kConvolutionMargin / Doubles::kCount;
    alignas(64) double buffer[kConvolutionMargin] = {};
    for (std::size_t i = 0; i < sums; ++i) {
        buffer[i] = sum[first + i];
    }
    Doubles parts[kParts];
    for (std::size_t part = 0; part < kParts; ++part) {
        parts[part] = Doubles::load(buffer + part * Doubles::kCount);
    }
    const std::size_t begin = first + 1 > tap_count ? first + 1 - tap_count : 0;
    const std::size_t end = first + kConvolutionMargin < count ? first + kConvolutionMargin : count;
    for (std::size_t n = begin; n < end; ++n) {
        const Doubles sample(factor * samples[n]);
        const double* row =
            taps + (static_cast<std::ptrdiff_t>(first) - static_cast<std::ptrdiff_t>(n));
        for (std::size_t part = 0; part < kParts; ++part) {
            const Doubles tap = Doubles::load_unaligned(row + part * Doubles::kCount);
            parts[part] = parts[part] + sample * tap;
        }
    }
    for (std::size_t part = 0; part < kParts; ++part) {
        parts[part].store(buffer + part * Doubles::kCount);
    }
    for (std::size_t i = 0; i < sums; ++i) {
        sum[first + i] = buffer[i];
    }
}

void add_convolution(double factor,
                     const double* samples,
                     std::size_t count,
                     const double* taps,
                     std::size_t tap_count,
                     double* sum) {
    const std::size_t size = count + tap_count - 1;
    for (std::size_t first = 0; first < size; first += kConvolutionMargin) {
        const std::size_t rest = size - first;
        const std::size_t sums = rest < kConvolutionMargin ? rest : kConvolutionMargin;
        add_to_block(factor, samples, count, taps, tap_count, first, sums, sum);
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(add_product);
HWY_EXPORT(add_scaled);
HWY_EXPORT(interpolate);
HWY_EXPORT(spread);
HWY_EXPORT(add_convolution);

void add_product(const double* a, const double* b, std::size_t count, double* sum) {
    HWY_DYNAMIC_DISPATCH(add_product)(a, b, count, sum);
}

void add_scaled(double factor, const double* values, std::size_t count, double* sum) {
    HWY_DYNAMIC_DISPATCH(add_scaled)(factor, values, count, sum);
}

void interpolate(
    const double* low, const double* high, double along, std::size_t count, double* values) {
    HWY_DYNAMIC_DISPATCH(interpolate)(low, high, along, count, values);
}

void spread(const double* taps,
            std::size_t tap_count,
            const double* weights,
            std::size_t train_count,
            std::size_t stride,
            double* trains) {
    HWY_DYNAMIC_DISPATCH(spread)(taps, tap_count, weights, train_count, stride, trains);
}

void add_convolution(double factor,
                     const double* samples,
                     std::size_t count,
                     const double* taps,
                     std::size_t tap_count,
                     double* sum) {
    HWY_DYNAMIC_DISPATCH(add_convolution)(factor, samples, count, taps, tap_count, sum);
}

}  // namespace earshot::audio
#endif
