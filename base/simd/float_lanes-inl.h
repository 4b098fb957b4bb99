// SPDX-License-Identifier: MIT
//
// What kernels do with four or eight floats besides arithmetic: conversions, shuffles of lanes and
// ordered compression; see lanes-inl.h.

#include "earshot/base/simd/lanes-inl.h"

#include <bit>
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

/// Has a compiler hold numbers in registers from here on, where it otherwise may read from
/// memory again in every round of a loop. Where a register takes fewer than eight floats there are
/// not enough of them for that.
HWY_INLINE void keep_in_registers([[maybe_unused]] Float8& a) {
#if HWY_ARCH_X86 && HWY_MAX_BYTES >= 32 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG)
    for_each_part<Float8::kParts>([&](std::size_t i) { asm("" : "+v"(a.part[i].raw)); });
#endif
}

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
/// The largest and the smallest of four lanes, in each lane.
HWY_INLINE Float4 max_of_lanes(const Float4& a) {
    const Float4 pairs = max(a, rotate_by_one(a));
    return max(pairs, rotate_by_two(pairs));
}
HWY_INLINE Float4 min_of_lanes(const Float4& a) {
    const Float4 pairs = min(a, rotate_by_one(a));
    return min(pairs, rotate_by_two(pairs));
}

/// Three doubles, and 0 in the fourth lane.
HWY_INLINE Double4 load_three(const double* numbers) {
#if HWY_MAX_BYTES >= 32
    return per_part<Double4>([&](std::size_t) {
        return hn::MaskedLoad(hn::FirstN(Double4::Tag(), 3), Double4::Tag(), numbers);
    });
#else
    alignas(16) const double padded[4] = {numbers[0], numbers[1], numbers[2], 0.0};
    return Double4::load(padded);
#endif
}
/// Four doubles rounded to floats.
HWY_INLINE Float4 round_to_float(const Double4& a) {
#if HWY_MAX_BYTES >= 32
    return per_part<Float4>([&](std::size_t) { return hn::DemoteTo(Float4::Tag(), a.part[0]); });
#else
    alignas(16) double numbers[4];
    alignas(16) float rounded[4];
    a.store(numbers);
    for (std::size_t i = 0; i < 4; ++i) {
        rounded[i] = static_cast<float>(numbers[i]);
    }
    return Float4::load(rounded);
#endif
}
/// Four floats as doubles.
HWY_INLINE Double4 to_double(const Float4& a) {
#if HWY_MAX_BYTES >= 32
    return per_part<Double4>([&](std::size_t) { return hn::PromoteTo(Double4::Tag(), a.part[0]); });
#else
    alignas(16) float numbers[4];
    alignas(16) double exact[4];
    a.store(numbers);
    for (std::size_t i = 0; i < 4; ++i) {
        exact[i] = static_cast<double>(numbers[i]);
    }
    return Double4::load(exact);
#endif
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

/// Three floats as doubles; the fourth lane is not used.
HWY_INLINE Double4 doubles_of(float a, float b, float c) {
#if HWY_MAX_BYTES >= 32
    const hn::CappedTag<float, 4> four;
    const auto ac = hn::InterleaveLower(four, hn::Set(four, a), hn::Set(four, c));
    const auto bc = hn::InterleaveLower(four, hn::Set(four, b), hn::Set(four, c));
    Float4 all;
    all.part[0] = hn::InterleaveLower(four, ac, bc);
    return to_double(all);
#else
    alignas(16) const double numbers[4] = {
        static_cast<double>(a), static_cast<double>(b), static_cast<double>(c), 0.0};
    return Double4::load(numbers);
#endif
}

/// Eight floats from two times four.
HWY_INLINE Float8 combine(const Float4& lower, const Float4& upper) {
#if HWY_MAX_BYTES >= 32
    return per_part<Float8>(
        [&](std::size_t) { return hn::Combine(Float8::Tag(), upper.part[0], lower.part[0]); });
#else
    return per_part<Float8>([&](std::size_t i) {
        return i < Float4::kParts ? lower.part[i] : upper.part[i - Float4::kParts];
    });
#endif
}

/// Eight rows of four doubles, rounded to floats and transposed: lane i of out[k] is rows[i][k].
HWY_INLINE void load_transposed(const double* const (&rows)[8], Float8 (&out)[4]) {
    Float4 halves[2][4];
    for (std::size_t h = 0; h < 2; ++h) {
        const auto row = [&](std::size_t i) {
            return round_to_float(Double4::load_unaligned(rows[4 * h + i]));
        };
        const Float4 a = row(0), b = row(1), c = row(2), d = row(3);
        const Float4 ac_lower = interleave_lower(a, c), bd_lower = interleave_lower(b, d);
        const Float4 ac_upper = interleave_upper(a, c), bd_upper = interleave_upper(b, d);
        halves[h][0] = interleave_lower(ac_lower, bd_lower);
        halves[h][1] = interleave_upper(ac_lower, bd_lower);
        halves[h][2] = interleave_lower(ac_upper, bd_upper);
        halves[h][3] = interleave_upper(ac_upper, bd_upper);
    }
    for (std::size_t k = 0; k < 4; ++k) {
        out[k] = combine(halves[0][k], halves[1][k]);
    }
}

/// Rows of three doubles, as many as Doubles has lanes, transposed: lane i of out[k] is rows[i][k].
HWY_INLINE void load_transposed(const double* const* rows, Doubles (&out)[3]) {
#if HWY_MAX_BYTES >= 32
    const Double4::Tag fours;
    constexpr std::size_t kHalves = Doubles::kCount / 4;
    hn::Vec<Double4::Tag> halves[kHalves][3];
    for (std::size_t h = 0; h < kHalves; ++h) {
        const auto row = [&](std::size_t i) { return load_three(rows[4 * h + i]).part[0]; };
        const auto a = row(0), b = row(1), c = row(2), d = row(3);
        const auto ab_even = hn::InterleaveLower(fours, a, b);
        const auto cd_even = hn::InterleaveLower(fours, c, d);
        halves[h][0] = hn::ConcatLowerLower(fours, cd_even, ab_even);
        halves[h][1] = hn::ConcatLowerLower(
            fours, hn::InterleaveUpper(fours, c, d), hn::InterleaveUpper(fours, a, b));
        halves[h][2] = hn::ConcatUpperUpper(fours, cd_even, ab_even);
    }
    for (std::size_t k = 0; k < 3; ++k) {
#if HWY_MAX_BYTES >= 64
        out[k].part[0] = hn::Combine(Doubles::Tag(), halves[1][k], halves[0][k]);
#else
        out[k].part[0] = halves[0][k];
#endif
    }
#else
    for (std::size_t k = 0; k < 3; ++k) {
        alignas(64) double lanes[Doubles::kCount];
        for (std::size_t i = 0; i < Doubles::kCount; ++i) {
            lanes[i] = rows[i][k];
        }
        out[k] = Doubles::load(lanes);
    }
#endif
}

/// Sets whole numbers in memory to `number` where the mask is true.
template <typename Mask>
HWY_INLINE void assign(const Mask& mask, std::uint32_t number, std::uint32_t* aligned) {
    const hn::RebindToUnsigned<typename Mask::Tag> words;
    for_each_part<Mask::kParts>([&](std::size_t i) {
        std::uint32_t* at = aligned + i * Mask::kPartLanes;
        const auto is_set = hn::RebindMask(words, mask.part[i]);
        hn::Store(hn::IfThenElse(is_set, hn::Set(words, number), hn::Load(words, at)), words, at);
    });
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

/// True where eight whole numbers differ from one.
HWY_INLINE Float8::Mask differs(const std::uint32_t* numbers, std::uint32_t number) {
    const hn::RebindToUnsigned<Float8::Tag> words;
    return per_part<Float8::Mask>([&](std::size_t i) {
        const auto part = hn::LoadU(words, numbers + i * Float8::kPartLanes);
        return hn::RebindMask(Float8::Tag(), hn::Ne(part, hn::Set(words, number)));
    });
}

#if HWY_TARGET == HWY_AVX2
/// The lanes of each mask of eight, the first ones first. Highway's own table for this set lies in
/// a function, where GCC copies it to the stack in every call.
struct MaskLanes {
    std::uint8_t lanes[256][8] = {};
};
constexpr MaskLanes make_mask_lanes() {
    MaskLanes table;
    for (std::size_t mask = 0; mask < 256; ++mask) {
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < 8; ++lane) {
            if ((mask >> lane & 1U) != 0) {
                table.lanes[mask][count++] = static_cast<std::uint8_t>(lane);
            }
        }
    }
    return table;
}
inline constexpr MaskLanes kMaskLanes = make_mask_lanes();
#endif

#if HWY_TARGET <= HWY_AVX2
/// Writes the masked lanes of two registers, in their order, and returns how many. Writes to all
/// eight elements of both outputs.
HWY_INLINE std::size_t store_compressed(hn::Vec<Float8::Tag> keys,
                                        hn::Vec<hn::RebindToUnsigned<Float8::Tag>> values,
                                        hn::Mask<Float8::Tag> mask,
                                        float* key_out,
                                        std::uint32_t* value_out) {
    const Float8::Tag floats;
    const hn::RebindToUnsigned<Float8::Tag> words;
#if HWY_TARGET == HWY_AVX2
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(floats, mask, bytes);
    const hn::Rebind<std::uint8_t, Float8::Tag> small;
    const auto lanes = hn::PromoteTo(words, hn::LoadU(small, kMaskLanes.lanes[bytes[0]]));
    hn::StoreU(hn::TableLookupLanes(keys, hn::IndicesFromVec(floats, lanes)), floats, key_out);
    hn::StoreU(hn::TableLookupLanes(values, hn::IndicesFromVec(words, lanes)), words, value_out);
#else
    hn::StoreU(hn::Compress(keys, mask), floats, key_out);
    hn::StoreU(hn::Compress(values, hn::RebindMask(words, mask)), words, value_out);
#endif
    return hn::CountTrue(floats, mask);
}
#endif

/// Writes the masked lanes of `key` and `value`, in their order, and returns how many. Writes to
/// all eight elements of both outputs.
HWY_INLINE std::size_t compress(const Float8& key,
                                const Float8::Mask& mask,
                                const std::uint32_t* value,
                                float* key_out,
                                std::uint32_t* value_out) {
#if HWY_TARGET <= HWY_AVX2
    const auto values = hn::LoadU(hn::RebindToUnsigned<Float8::Tag>(), value);
    return store_compressed(key.part[0], values, mask.part[0], key_out, value_out);
#else
    alignas(32) float keys[8];
    key.store(keys);
    const std::uint32_t valid = bits(mask);
    std::size_t count = 0;
    for (std::size_t lane = 0; lane < 8; ++lane) {
        key_out[count] = keys[lane];
        value_out[count] = value[lane];
        count += valid >> lane & 1U;
    }
    return count;
#endif
}

/// Writes the elements of `value` whose bits are set, in their order, and returns how many. Writes
/// to all eight elements of the output.
HWY_INLINE std::size_t compress_words(std::uint32_t mask,
                                      const std::uint32_t* value,
                                      std::uint32_t* value_out) {
#if HWY_TARGET <= HWY_AVX3
    const hn::RebindToUnsigned<Float8::Tag> words;
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(mask)};
    hn::StoreU(
        hn::Compress(hn::LoadU(words, value), hn::LoadMaskBits(words, bytes)), words, value_out);
#elif HWY_TARGET == HWY_AVX2
    const hn::RebindToUnsigned<Float8::Tag> words;
    const hn::Rebind<std::uint8_t, Float8::Tag> small;
    const auto lanes = hn::PromoteTo(words, hn::LoadU(small, kMaskLanes.lanes[mask]));
    hn::StoreU(hn::TableLookupLanes(hn::LoadU(words, value), hn::IndicesFromVec(words, lanes)),
               words,
               value_out);
#else
    std::uint32_t* out = value_out;
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
        *out++ = value[std::countr_zero(rest)];
    }
#endif
    return static_cast<std::size_t>(std::popcount(mask));
}

#if HWY_TARGET <= HWY_AVX2
/// Eight lanes in the order of compress_ordered().
struct OrderedLanes {
    hn::Vec<Float8::Tag> near;
    hn::Vec<hn::RebindToUnsigned<Float8::Tag>> value;
    hn::Mask<Float8::Tag> valid;  // `near` is not beyond `far`

    HWY_INLINE OrderedLanes(const Float8& from,
                            const Float8& far,
                            const std::uint32_t* values,
                            const std::uint32_t* order,
                            int shift) {
        const Float8::Tag floats;
        const hn::RebindToUnsigned<Float8::Tag> words;
        const auto lanes =
            hn::And(hn::ShiftRightSame(hn::Load(words, order), shift), hn::Set(words, 7U));
        const auto indices = hn::IndicesFromVec(floats, lanes);
        // Comparing what is in order already is faster than ordering what has been compared.
        near = hn::TableLookupLanes(from.part[0], indices);
        valid = hn::Le(near, hn::TableLookupLanes(far.part[0], indices));
        value = hn::TableLookupLanes(hn::Load(words, values), hn::IndicesFromVec(words, lanes));
    }
};
#endif

/// Writes the lanes of `near` and `value` where `near` is not beyond `far`, in the order that
/// `order` gives: its lane r names in bits shift ... shift + 2 the lane that comes r-th. Returns
/// how many; writes to all eight elements of both outputs.
HWY_INLINE std::size_t compress_ordered(const Float8& near,
                                        const Float8& far,
                                        const std::uint32_t* value,
                                        const std::uint32_t* order,
                                        int shift,
                                        float* near_out,
                                        std::uint32_t* value_out) {
#if HWY_TARGET <= HWY_AVX2
    const OrderedLanes ordered(near, far, value, order, shift);
    return store_compressed(ordered.near, ordered.value, ordered.valid, near_out, value_out);
#else
    alignas(32) float nears[8];
    near.store(nears);
    const std::uint32_t valid = bits(near <= far);
    std::size_t count = 0;
    for (std::size_t r = 0; r < 8; ++r) {
        const std::uint32_t lane = order[r] >> shift & 7U;
        near_out[count] = nears[lane];
        value_out[count] = value[lane];
        count += valid >> lane & 1U;
    }
    return count;
#endif
}

/// The same, but the last value that would be written is `last`, and neither written nor counted.
/// It is known sooner than from memory after that. Precondition: there is one.
HWY_INLINE std::size_t compress_before_last(const Float8& near,
                                            const Float8& far,
                                            const std::uint32_t* value,
                                            const std::uint32_t* order,
                                            int shift,
                                            float* near_out,
                                            std::uint32_t* value_out,
                                            std::uint32_t& last) {
#if HWY_TARGET <= HWY_AVX2
    const OrderedLanes ordered(near, far, value, order, shift);
    // Stored before it is known which one is the last.
    alignas(32) std::uint32_t values[8];
    hn::Store(ordered.value, hn::RebindToUnsigned<Float8::Tag>(), values);
    Float8::Mask valid;
    valid.part[0] = ordered.valid;
    last = values[std::bit_width(bits(valid)) - 1];
    return store_compressed(ordered.near, ordered.value, ordered.valid, near_out, value_out) - 1;
#else
    const std::size_t count = compress_ordered(near, far, value, order, shift, near_out, value_out);
    last = value_out[count - 1];
    return count - 1;
#endif
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
