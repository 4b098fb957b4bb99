// SPDX-License-Identifier: MIT
//
// Directed rounding of doubles to floats; see lanes-inl.h.

#include "earshot/base/simd/float_lanes-inl.h"

#include <cstdint>

#if defined(EARSHOT_BASE_SIMD_ROUNDING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BASE_SIMD_ROUNDING_INL_H
#undef EARSHOT_BASE_SIMD_ROUNDING_INL_H
#else
#define EARSHOT_BASE_SIMD_ROUNDING_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

/// The next floats below finite ones.
HWY_INLINE Float4 next_below(const Float4& number) {
    return map<Float4>(
        [](const auto& part) {
            const Float4::Tag floats;
            const hn::RebindToSigned<Float4::Tag> words;
            // The bits of positive floats count up, of negative ones down, and below both zeros is
            // the least negative float.
            constexpr std::int32_t kLeastNegative = std::numeric_limits<std::int32_t>::min() + 1;
            const auto bits = hn::BitCast(words, part);
            const auto step = hn::IfThenElse(
                hn::Gt(bits, hn::Zero(words)), hn::Set(words, -1), hn::Set(words, 1));
            const auto below = hn::BitCast(floats, hn::Add(bits, step));
            return hn::IfThenElse(hn::Eq(part, hn::Zero(floats)),
                                  hn::BitCast(floats, hn::Set(words, kLeastNegative)),
                                  below);
        },
        number);
}

/// The largest floats that are not above four doubles; no zero is negative.
HWY_INLINE Float4 round_down(const Double4& value) {
    const Float4 nearest = round_to_float(value);
    const Double4 is_above = select(value < to_double(nearest), Double4(1.0), Double4(0.0));
    return select(Float4(0.0F) < round_to_float(is_above), next_below(nearest), nearest) +
           Float4(0.0F);
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
