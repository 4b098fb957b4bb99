// SPDX-License-Identifier: MIT
//
// Lanes of doubles for kernels that are compiled once per instruction set; the only place that
// knows Highway's operations. A kernel file starts with
//     #undef HWY_TARGET_INCLUDE
//     #define HWY_TARGET_INCLUDE "earshot/FOLDER/NAME_kernel.cpp"
//     #include <hwy/foreach_target.h>
//     #include "earshot/base/wide.h"
// and is then included again for every set, which is why this header has a guard per target.

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#if defined(EARSHOT_BASE_WIDE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BASE_WIDE_H
#undef EARSHOT_BASE_WIDE_H
#else
#define EARSHOT_BASE_WIDE_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// As many doubles as a register holds, at most 8. No operation fuses a product with a sum, so
/// every set computes the same bits.
using DoubleTag = hn::CappedTag<double, 8>;
using Doubles = hn::Vec<DoubleTag>;

HWY_INLINE std::size_t lanes() {
    return hn::Lanes(DoubleTag());
}
HWY_INLINE Doubles load(const double* aligned) {
    return hn::Load(DoubleTag(), aligned);
}
HWY_INLINE Doubles broadcast(double value) {
    return hn::Set(DoubleTag(), value);
}
HWY_INLINE Doubles add(Doubles a, Doubles b) {
    return hn::Add(a, b);
}
HWY_INLINE Doubles multiply(Doubles a, Doubles b) {
    return hn::Mul(a, b);
}
HWY_INLINE void store(Doubles a, double* aligned) {
    hn::Store(a, DoubleTag(), aligned);
}
HWY_INLINE Doubles subtract(Doubles a, Doubles b) {
    return hn::Sub(a, b);
}
HWY_INLINE Doubles divide(Doubles a, Doubles b) {
    return hn::Div(a, b);
}
HWY_INLINE Doubles absolute(Doubles a) {
    return hn::Abs(a);
}
HWY_INLINE Doubles lesser(Doubles a, Doubles b) {
    return hn::Min(a, b);
}
HWY_INLINE Doubles greater(Doubles a, Doubles b) {
    return hn::Max(a, b);
}
using DoublesMask = hn::Mask<DoubleTag>;
HWY_INLINE DoublesMask at_most(Doubles a, Doubles b) {
    return hn::Le(a, b);
}
HWY_INLINE DoublesMask below(Doubles a, Doubles b) {
    return hn::Lt(a, b);
}
HWY_INLINE DoublesMask both(DoublesMask a, DoublesMask b) {
    return hn::And(a, b);
}
HWY_INLINE DoublesMask either(DoublesMask a, DoublesMask b) {
    return hn::Or(a, b);
}
/// The first and not the second.
HWY_INLINE DoublesMask but_not(DoublesMask a, DoublesMask b) {
    return hn::AndNot(b, a);
}
HWY_INLINE Doubles choose(DoublesMask mask, Doubles yes, Doubles no) {
    return hn::IfThenElse(mask, yes, no);
}
HWY_INLINE DoublesMask choose(DoublesMask mask, DoublesMask yes, DoublesMask no) {
    return either(both(mask, yes), but_not(no, mask));
}
/// Bit i is lane i.
HWY_INLINE std::uint32_t bits(DoublesMask mask) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(DoubleTag(), mask, bytes);
    return bytes[0];
}
/// Bit i: a <= b in lane i.
HWY_INLINE std::uint32_t at_most_bits(Doubles a, Doubles b) {
    return bits(at_most(a, b));
}
HWY_INLINE bool any_less(Doubles a, Doubles b) {
    return !hn::AllFalse(DoubleTag(), hn::Lt(a, b));
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
