// SPDX-License-Identifier: MIT
//
// Four floats at a time, for kernels that are compiled once per instruction set; see base/wide.h
// for how such a file is included, and why this header has a guard per target. Nothing is fused and
// no lane depends on another, so every set computes the same bits from numbers.

#include "earshot/base/wide.h"

#include <bit>
#include <cstdint>

#if defined(EARSHOT_BVH_KERNELS_QUAD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_QUAD_INL_H
#undef EARSHOT_BVH_KERNELS_QUAD_INL_H
#else
#define EARSHOT_BVH_KERNELS_QUAD_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

/// 2^23: floats from here on are whole numbers, so that adding it rounds to the nearest, ties to
/// even, and leaves the number in the lowest bits.
constexpr float kRounder = 8388608.0F;

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

/// The axes of something and a spare lane, or one thing of four boxes.
using QuadTag = hn::FixedTag<float, 4>;
using Quad = hn::Vec<QuadTag>;
using QuadMask = hn::Mask<QuadTag>;

HWY_INLINE Quad load_quad(const float* aligned) {
    return hn::Load(QuadTag(), aligned);
}
HWY_INLINE Quad load_unaligned(const float* numbers) {
    return hn::LoadU(QuadTag(), numbers);
}
HWY_INLINE void store_quad(Quad quad, float* aligned) {
    hn::Store(quad, QuadTag(), aligned);
}
HWY_INLINE Quad all_four(float value) {
    return hn::Set(QuadTag(), value);
}
HWY_INLINE Quad add(Quad a, Quad b) {
    return hn::Add(a, b);
}
HWY_INLINE Quad subtract(Quad a, Quad b) {
    return hn::Sub(a, b);
}
HWY_INLINE Quad multiply(Quad a, Quad b) {
    return hn::Mul(a, b);
}
HWY_INLINE Quad divide(Quad a, Quad b) {
    return hn::Div(a, b);
}
/// Precondition: no lane is not a number, here and below.
HWY_INLINE Quad smaller(Quad a, Quad b) {
    return hn::Min(a, b);
}
HWY_INLINE Quad larger(Quad a, Quad b) {
    return hn::Max(a, b);
}
/// False where a lane is not a number.
HWY_INLINE QuadMask less(Quad a, Quad b) {
    return hn::Lt(a, b);
}
HWY_INLINE Quad select(QuadMask mask, Quad yes, Quad no) {
    return hn::IfThenElse(mask, yes, no);
}
/// Bit i: lane i of a is not above that of b.
HWY_INLINE unsigned bits_where_not_above(Quad a, Quad b) {
    alignas(16) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(QuadTag(), hn::Le(a, b), bytes);
    return bytes[0];
}
/// Lanes moved down by one and by two places, around the end.
HWY_INLINE Quad next(Quad quad) {
    return hn::Shuffle0321(quad);
}
HWY_INLINE Quad opposite(Quad quad) {
    return hn::Shuffle1032(quad);
}
/// a0 b0 a1 b1, and a2 b2 a3 b3.
HWY_INLINE Quad interleave_lower(Quad a, Quad b) {
    return hn::InterleaveLower(QuadTag(), a, b);
}
HWY_INLINE Quad interleave_upper(Quad a, Quad b) {
    return hn::InterleaveUpper(QuadTag(), a, b);
}
/// Whole numbers below 2^24 as floats.
HWY_INLINE Quad load_counts(const std::int32_t* aligned) {
    return hn::ConvertTo(QuadTag(), hn::Load(hn::RebindToSigned<QuadTag>(), aligned));
}
/// The lowest bits of three lanes, all that are in the mask.
HWY_INLINE void store_bits(Quad quad, std::int32_t mask, std::uint32_t bits[3]) {
    const hn::RebindToSigned<QuadTag> tag;
    const auto lanes = hn::And(hn::BitCast(tag, quad), hn::Set(tag, mask));
    bits[0] = static_cast<std::uint32_t>(hn::ExtractLane(lanes, 0));
    bits[1] = static_cast<std::uint32_t>(hn::ExtractLane(lanes, 1));
    bits[2] = static_cast<std::uint32_t>(hn::ExtractLane(lanes, 2));
}

#else

struct Quad {
    float lane[4];
};
struct QuadMask {
    bool lane[4];
};

template <class Operation>
Quad of_lanes(const Operation& operation) {
    return {{operation(0), operation(1), operation(2), operation(3)}};
}

inline Quad load_quad(const float* aligned) {
    return of_lanes([&](int i) { return aligned[i]; });
}
inline Quad load_unaligned(const float* numbers) {
    return load_quad(numbers);
}
inline void store_quad(Quad quad, float* aligned) {
    for (int i = 0; i < 4; ++i) {
        aligned[i] = quad.lane[i];
    }
}
inline Quad all_four(float value) {
    return {{value, value, value, value}};
}
inline Quad add(Quad a, Quad b) {
    return of_lanes([&](int i) { return a.lane[i] + b.lane[i]; });
}
inline Quad subtract(Quad a, Quad b) {
    return of_lanes([&](int i) { return a.lane[i] - b.lane[i]; });
}
inline Quad multiply(Quad a, Quad b) {
    return of_lanes([&](int i) { return a.lane[i] * b.lane[i]; });
}
inline Quad divide(Quad a, Quad b) {
    return of_lanes([&](int i) { return a.lane[i] / b.lane[i]; });
}
inline Quad smaller(Quad a, Quad b) {
    return of_lanes([&](int i) { return a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i]; });
}
inline Quad larger(Quad a, Quad b) {
    return of_lanes([&](int i) { return a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i]; });
}
inline QuadMask less(Quad a, Quad b) {
    return {{a.lane[0] < b.lane[0],
             a.lane[1] < b.lane[1],
             a.lane[2] < b.lane[2],
             a.lane[3] < b.lane[3]}};
}
inline Quad select(QuadMask mask, Quad yes, Quad no) {
    return of_lanes([&](int i) { return mask.lane[i] ? yes.lane[i] : no.lane[i]; });
}
inline unsigned bits_where_not_above(Quad a, Quad b) {
    unsigned bits = 0;
    for (unsigned i = 0; i < 4; ++i) {
        bits |= a.lane[i] <= b.lane[i] ? 1U << i : 0U;
    }
    return bits;
}
inline Quad next(Quad quad) {
    return of_lanes([&](int i) { return quad.lane[(i + 1) % 4]; });
}
inline Quad opposite(Quad quad) {
    return of_lanes([&](int i) { return quad.lane[(i + 2) % 4]; });
}
inline Quad interleave_lower(Quad a, Quad b) {
    return {{a.lane[0], b.lane[0], a.lane[1], b.lane[1]}};
}
inline Quad interleave_upper(Quad a, Quad b) {
    return {{a.lane[2], b.lane[2], a.lane[3], b.lane[3]}};
}
inline Quad load_counts(const std::int32_t* aligned) {
    return of_lanes([&](int i) { return static_cast<float>(aligned[i]); });
}
inline void store_bits(Quad quad, std::int32_t mask, std::uint32_t bits[3]) {
    for (int i = 0; i < 3; ++i) {
        bits[i] = std::bit_cast<std::uint32_t>(quad.lane[i]) & static_cast<std::uint32_t>(mask);
    }
}

#endif

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
