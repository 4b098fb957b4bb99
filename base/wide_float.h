// SPDX-License-Identifier: MIT
//
// Eight floats at a time, in one register or several, for kernels that are compiled once per
// instruction set (see wide.h, whose rules hold here too). Products and sums may be fused: these
// lanes only cull, with bounds that hold either way.

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <limits>

#if defined(EARSHOT_BASE_WIDE_FLOAT_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BASE_WIDE_FLOAT_H
#undef EARSHOT_BASE_WIDE_FLOAT_H
#else
#define EARSHOT_BASE_WIDE_FLOAT_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 8>;
using WordTag = hn::RebindToUnsigned<FloatTag>;
inline constexpr std::size_t kFloatLanes = hn::MaxLanes(FloatTag());
inline constexpr std::size_t kParts = 8 / kFloatLanes;

struct Float8 {
    hn::Vec<FloatTag> part[kParts];
};
struct Mask8 {
    hn::Mask<FloatTag> part[kParts];
};

template <typename Operation>
HWY_INLINE Float8 per_part(Operation&& operation) {
    Float8 result;
    for (std::size_t i = 0; i < kParts; ++i) {
        result.part[i] = operation(i);
    }
    return result;
}

HWY_INLINE Float8 load8(const float* aligned) {
    return per_part([&](std::size_t i) { return hn::Load(FloatTag(), aligned + i * kFloatLanes); });
}
/// The floats whose bits stand in eight words.
HWY_INLINE Float8 load8_words(const std::uint32_t* words) {
    return per_part([&](std::size_t i) {
        return hn::BitCast(FloatTag(), hn::LoadU(WordTag(), words + i * kFloatLanes));
    });
}
/// Eight numbers of 16 bits.
HWY_INLINE Float8 load8_halves(const std::uint16_t* halves) {
    const hn::Rebind<std::uint16_t, FloatTag> tag;
    return per_part([&](std::size_t i) {
        const auto whole =
            hn::PromoteTo(hn::RebindToSigned<FloatTag>(), hn::LoadU(tag, halves + i * kFloatLanes));
        return hn::ConvertTo(FloatTag(), whole);
    });
}
HWY_INLINE void store8_words(const Float8& a, std::uint32_t* words) {
    for (std::size_t i = 0; i < kParts; ++i) {
        hn::StoreU(hn::BitCast(WordTag(), a.part[i]), WordTag(), words + i * kFloatLanes);
    }
}
HWY_INLINE void store8(const Float8& a, float* aligned) {
    for (std::size_t i = 0; i < kParts; ++i) {
        hn::Store(a.part[i], FloatTag(), aligned + i * kFloatLanes);
    }
}
HWY_INLINE Float8 set8(float value) {
    return per_part([&](std::size_t) { return hn::Set(FloatTag(), value); });
}
HWY_INLINE Float8 operator+(const Float8& a, const Float8& b) {
    return per_part([&](std::size_t i) { return hn::Add(a.part[i], b.part[i]); });
}
HWY_INLINE Float8 operator-(const Float8& a, const Float8& b) {
    return per_part([&](std::size_t i) { return hn::Sub(a.part[i], b.part[i]); });
}
HWY_INLINE Float8 operator*(const Float8& a, const Float8& b) {
    return per_part([&](std::size_t i) { return hn::Mul(a.part[i], b.part[i]); });
}
HWY_INLINE Float8 operator/(const Float8& a, const Float8& b) {
    return per_part([&](std::size_t i) { return hn::Div(a.part[i], b.part[i]); });
}
/// a * b + c
HWY_INLINE Float8 multiply_add(const Float8& a, const Float8& b, const Float8& c) {
    return per_part([&](std::size_t i) { return hn::MulAdd(a.part[i], b.part[i], c.part[i]); });
}
/// c - a * b
HWY_INLINE Float8 subtract_product(const Float8& a, const Float8& b, const Float8& c) {
    return per_part([&](std::size_t i) { return hn::NegMulAdd(a.part[i], b.part[i], c.part[i]); });
}
HWY_INLINE Float8 minimum(const Float8& a, const Float8& b) {
    return per_part([&](std::size_t i) { return hn::Min(a.part[i], b.part[i]); });
}
HWY_INLINE Float8 maximum(const Float8& a, const Float8& b) {
    return per_part([&](std::size_t i) { return hn::Max(a.part[i], b.part[i]); });
}
HWY_INLINE Float8 magnitude(const Float8& a) {
    return per_part([&](std::size_t i) { return hn::Abs(a.part[i]); });
}
HWY_INLINE Float8 choose(const Mask8& mask, const Float8& yes, const Float8& no) {
    return per_part(
        [&](std::size_t i) { return hn::IfThenElse(mask.part[i], yes.part[i], no.part[i]); });
}

template <typename Operation>
HWY_INLINE Mask8 mask_per_part(Operation&& operation) {
    Mask8 result;
    for (std::size_t i = 0; i < kParts; ++i) {
        result.part[i] = operation(i);
    }
    return result;
}

HWY_INLINE Mask8 at_most(const Float8& a, const Float8& b) {
    return mask_per_part([&](std::size_t i) { return hn::Le(a.part[i], b.part[i]); });
}
HWY_INLINE Mask8 below(const Float8& a, const Float8& b) {
    return mask_per_part([&](std::size_t i) { return hn::Lt(a.part[i], b.part[i]); });
}
HWY_INLINE Mask8 both(const Mask8& a, const Mask8& b) {
    return mask_per_part([&](std::size_t i) { return hn::And(a.part[i], b.part[i]); });
}
HWY_INLINE Mask8 either(const Mask8& a, const Mask8& b) {
    return mask_per_part([&](std::size_t i) { return hn::Or(a.part[i], b.part[i]); });
}
/// The first and not the second.
HWY_INLINE Mask8 but_not(const Mask8& a, const Mask8& b) {
    return mask_per_part([&](std::size_t i) { return hn::AndNot(b.part[i], a.part[i]); });
}
/// The first `count` lanes, 1 ... 8.
HWY_INLINE Mask8 first_lanes(std::size_t count) {
    return mask_per_part([&](std::size_t i) {
        const std::size_t before = i * kFloatLanes;
        return hn::FirstN(FloatTag(), count > before ? count - before : 0);
    });
}
/// Bit i is lane i.
HWY_INLINE std::uint32_t bits(const Mask8& mask) {
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < kParts; ++i) {
        alignas(8) std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(FloatTag(), mask.part[i], bytes);
        result |= static_cast<std::uint32_t>(bytes[0]) << (i * kFloatLanes);
    }
    return result;
}
/// The smallest lane.
HWY_INLINE float smallest(const Float8& a) {
    auto least = a.part[0];
    for (std::size_t i = 1; i < kParts; ++i) {
        least = hn::Min(least, a.part[i]);
    }
    return hn::GetLane(hn::MinOfLanes(FloatTag(), least));
}
/// The largest lane.
HWY_INLINE float largest(const Float8& a) {
    auto most = a.part[0];
    for (std::size_t i = 1; i < kParts; ++i) {
        most = hn::Max(most, a.part[i]);
    }
    return hn::GetLane(hn::MaxOfLanes(FloatTag(), most));
}

/// Writes the masked lanes of `key` and `value`, in the order that `order` gives: its lane r names
/// in bits shift ... shift + 2 the lane that comes r-th. Returns how many; writes to all eight
/// places of both outputs.
HWY_INLINE std::size_t compress_ordered(const Float8& key,
                                        const Mask8& mask,
                                        const std::uint32_t* value,
                                        const std::uint32_t* order,
                                        int shift,
                                        float* key_out,
                                        std::uint32_t* value_out) {
#if HWY_TARGET <= HWY_AVX2
    const FloatTag floats;
    const WordTag words;
    const auto lanes =
        hn::And(hn::ShiftRightSame(hn::Load(words, order), shift), hn::Set(words, 7U));
    const auto infinity = hn::Set(floats, std::numeric_limits<float>::infinity());
    const auto masked = hn::IfThenElse(mask.part[0], key.part[0], infinity);
    const auto keys = hn::TableLookupLanes(masked, hn::IndicesFromVec(floats, lanes));
    const auto values =
        hn::TableLookupLanes(hn::Load(words, value), hn::IndicesFromVec(words, lanes));
    const auto valid = hn::Lt(keys, infinity);
    hn::StoreU(hn::Compress(keys, valid), floats, key_out);
    hn::StoreU(hn::Compress(values, hn::RebindMask(words, valid)), words, value_out);
    return hn::CountTrue(floats, valid);
#else
    alignas(32) float keys[8];
    store8(key, keys);
    const std::uint32_t valid = bits(mask);
    std::size_t count = 0;
    for (std::size_t r = 0; r < 8; ++r) {
        const std::uint32_t lane = order[r] >> shift & 7U;
        key_out[count] = keys[lane];
        value_out[count] = value[lane];
        count += valid >> lane & 1U;
    }
    return count;
#endif
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
