// SPDX-License-Identifier: MIT
//
// Sums of long rows of numbers with the same bits at any width: eight partial sums, number n in sum
// n mod 8, added in a fixed order at the end.
#include "earshot/base/simd/lanes-inl.h"

#include <algorithm>

#if defined(EARSHOT_AUDIO_KERNELS_EIGHT_SUMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_AUDIO_KERNELS_EIGHT_SUMS_INL_H
#undef EARSHOT_AUDIO_KERNELS_EIGHT_SUMS_INL_H
#else
#define EARSHOT_AUDIO_KERNELS_EIGHT_SUMS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

using Eight = Lanes<double, 8>;

HWY_INLINE double total(Eight sums) {
    alignas(64) double s[8];
    sums.store(s);
    return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
}

/// 0, 1, ... 7.
HWY_INLINE Eight lane_numbers() {
    alignas(64) constexpr double kNumbers[8] = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
    return Eight::load(kNumbers);
}

/// Calls step(eight numbers, index of the first) for all numbers; `beyond` stands behind the last.
template <typename Step>
HWY_INLINE void for_each_eight(const double* numbers,
                               std::size_t count,
                               double beyond,
                               const Step& step) {
    std::size_t n = 0;
    for (; n + 8 <= count; n += 8) {
        step(Eight::load_unaligned(numbers + n), n);
    }
    if (n < count) {
        alignas(64) double last[8];
        std::fill(std::copy(numbers + n, numbers + count, last), last + 8, beyond);
        step(Eight::load(last), n);
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
