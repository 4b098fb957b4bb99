// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/correlation_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/correlation_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/audio/kernels/eight_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

double product_sum(const double* a, const double* b, std::size_t count) {
    Eight sum(0.0);
    const std::size_t whole = count / 8 * 8;
    for (std::size_t n = 0; n < whole; n += 8) {
        sum = sum + Eight::load_unaligned(a + n) * Eight::load_unaligned(b + n);
    }
    alignas(64) double sums[8];
    sum.store(sums);
    for (std::size_t n = whole; n < count; ++n) {
        sums[n - whole] += a[n] * b[n];
    }
    return total(Eight::load(sums));
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(product_sum);

double dot_product(std::span<const double> a, std::span<const double> b) {
    return HWY_DYNAMIC_DISPATCH(product_sum)(a.data(), b.data(), a.size());
}

}  // namespace earshot::audio
#endif
