// SPDX-License-Identifier: MIT
//
// What kernels do with four or eight floats besides arithmetic: conversions, shuffles of lanes and
// ordered compression; see lanes-inl.h.

#include "earshot/base/simd/lanes-inl.h"

#include <cstddef>
#include <cstdint>
#include <limits>

#if defined(EARSHOT_BASE_SIMD_FLOAT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BASE_SIMD_FLOAT_LANES_INL_H
#undef EARSHOT_BASE_SIMD_FLOAT_LANES_INL_H
#else
#define EARSHOT_BASE_SIMD_FLOAT_LANES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

/// Eight floats from their bits.
HWY_INLINE Float8 load_bits(const std::uint32_t* words) {
    return per_part<Float8>([&](std::size_t i) {
        const hn::RebindToUnsigned<Float8::Tag> tag;
        return hn::BitCast(Float8::Tag(), hn::LoadU(tag, words + i * Float8::kPartLanes));
    });
}
/// The bits of eight floats.
HWY_INLINE void store_bits(const Float8& a, std::uint32_t* words) {
    const hn::RebindToUnsigned<Float8::Tag> tag;
    for (std::size_t i = 0; i < Float8::kParts; ++i) {
        hn::StoreU(hn::BitCast(tag, a.part[i]), tag, words + i * Float8::kPartLanes);
    }
}
/// Eight whole numbers of 16 bits.
HWY_INLINE Float8 load_uint16(const std::uint16_t* numbers) {
    const hn::Rebind<std::uint16_t, Float8::Tag> tag;
    return per_part<Float8>([&](std::size_t i) {
        const auto wide = hn::PromoteTo(hn::RebindToSigned<Float8::Tag>(),
                                        hn::LoadU(tag, numbers + i * Float8::kPartLanes));
        return hn::ConvertTo(Float8::Tag(), wide);
    });
}
/// Four whole numbers below 2^24.
HWY_INLINE Float4 load_int32(const std::int32_t* aligned) {
    const hn::RebindToSigned<Float4::Tag> tag;
    return per_part<Float4>([&](std::size_t i) {
        return hn::ConvertTo(Float4::Tag(), hn::Load(tag, aligned + i * Float4::kPartLanes));
    });
}
/// The bits of the first three lanes that are in the mask.
HWY_INLINE void store_masked_bits(const Float4& a, std::int32_t mask, std::uint32_t words[3]) {
    const hn::RebindToSigned<Float4::Tag> tag;
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 3; ++i) {
        const auto lane = hn::And(hn::BitCast(tag, a.part[i]), hn::Set(tag, mask));
        words[i] = static_cast<std::uint32_t>(hn::GetLane(lane));
    }
#else
    const auto lanes = hn::And(hn::BitCast(tag, a.part[0]), hn::Set(tag, mask));
    words[0] = static_cast<std::uint32_t>(hn::ExtractLane(lanes, 0));
    words[1] = static_cast<std::uint32_t>(hn::ExtractLane(lanes, 1));
    words[2] = static_cast<std::uint32_t>(hn::ExtractLane(lanes, 2));
#endif
}

/// Lanes moved down by one place, around the end: a1 a2 a3 a0.
HWY_INLINE Float4 rotate_by_one(const Float4& a) {
    Float4 result;
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 4; ++i) {
        result.part[i] = a.part[(i + 1) % 4];
    }
#else
    result.part[0] = hn::Shuffle0321(a.part[0]);
#endif
    return result;
}
/// Lanes moved by two places: a2 a3 a0 a1.
HWY_INLINE Float4 rotate_by_two(const Float4& a) {
    Float4 result;
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 4; ++i) {
        result.part[i] = a.part[(i + 2) % 4];
    }
#else
    result.part[0] = hn::Shuffle1032(a.part[0]);
#endif
    return result;
}
/// a0 b0 a1 b1.
HWY_INLINE Float4 interleave_lower(const Float4& a, const Float4& b) {
    Float4 result;
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 4; ++i) {
        result.part[i] = (i % 2 == 0 ? a : b).part[i / 2];
    }
#else
    result.part[0] = hn::InterleaveLower(Float4::Tag(), a.part[0], b.part[0]);
#endif
    return result;
}
/// a2 b2 a3 b3.
HWY_INLINE Float4 interleave_upper(const Float4& a, const Float4& b) {
    Float4 result;
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 4; ++i) {
        result.part[i] = (i % 2 == 0 ? a : b).part[2 + i / 2];
    }
#else
    result.part[0] = hn::InterleaveUpper(Float4::Tag(), a.part[0], b.part[0]);
#endif
    return result;
}

/// The first four lanes, the last four, and both exchanged.
#if HWY_MAX_BYTES >= 32
HWY_INLINE Float4 lower_half(const Float8& a) {
    return per_part<Float4>([&](std::size_t) { return hn::LowerHalf(Float4::Tag(), a.part[0]); });
}
HWY_INLINE Float4 upper_half(const Float8& a) {
    return per_part<Float4>([&](std::size_t) { return hn::UpperHalf(Float4::Tag(), a.part[0]); });
}
HWY_INLINE Float8 swap_halves(const Float8& a) {
    return per_part<Float8>(
        [&](std::size_t) { return hn::ReverseBlocks(Float8::Tag(), a.part[0]); });
}
#else
HWY_INLINE Float4 lower_half(const Float8& a) {
    return per_part<Float4>([&](std::size_t i) { return a.part[i]; });
}
HWY_INLINE Float4 upper_half(const Float8& a) {
    return per_part<Float4>([&](std::size_t i) { return a.part[Float4::kParts + i]; });
}
HWY_INLINE Float8 swap_halves(const Float8& a) {
    return per_part<Float8>(
        [&](std::size_t i) { return a.part[(i + Float4::kParts) % Float8::kParts]; });
}
#endif

/// Writes the masked lanes of `key` and `value`, in the order that `order` gives: its lane r names
/// in bits shift ... shift + 2 the lane that comes r-th. Returns how many; writes to all eight
/// elements of both outputs.
HWY_INLINE std::size_t compress_ordered(const Float8& key,
                                        const Float8::Mask& mask,
                                        const std::uint32_t* value,
                                        const std::uint32_t* order,
                                        int shift,
                                        float* key_out,
                                        std::uint32_t* value_out) {
#if HWY_TARGET <= HWY_AVX2
    const Float8::Tag floats;
    const hn::RebindToUnsigned<Float8::Tag> words;
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
    key.store(keys);
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
