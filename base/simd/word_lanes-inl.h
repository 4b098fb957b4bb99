// SPDX-License-Identifier: MIT
//
// Words of 64 bits beside the lanes of Doubles, and points read into lanes; see lanes-inl.h.

#include "earshot/base/simd/lanes-inl.h"

#include <cstddef>
#include <cstdint>

#if defined(EARSHOT_BASE_SIMD_WORD_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BASE_SIMD_WORD_LANES_INL_H
#undef EARSHOT_BASE_SIMD_WORD_LANES_INL_H
#else
#define EARSHOT_BASE_SIMD_WORD_LANES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

/// As many words as Doubles has lanes.
struct Words {
    static_assert(Doubles::kParts == 1);
    using Tag = hn::RebindToUnsigned<Doubles::Tag>;

    hn::Vec<Tag> part;

    Words() = default;
    HWY_INLINE explicit Words(std::uint64_t value) : part(hn::Set(Tag(), value)) {}
    HWY_INLINE explicit Words(hn::Vec<Tag> lanes) : part(lanes) {}

    HWY_INLINE static Words load(const std::uint64_t* aligned) {
        return Words(hn::Load(Tag(), aligned));
    }
    HWY_INLINE void store(std::uint64_t* aligned) const { hn::Store(part, Tag(), aligned); }
};

HWY_INLINE Words operator+(Words a, Words b) {
    return Words(hn::Add(a.part, b.part));
}
HWY_INLINE Words operator-(Words a, Words b) {
    return Words(hn::Sub(a.part, b.part));
}
HWY_INLINE Words operator|(Words a, Words b) {
    return Words(hn::Or(a.part, b.part));
}
HWY_INLINE Words operator&(Words a, Words b) {
    return Words(hn::And(a.part, b.part));
}
/// Lane by lane; shifts are less than 64.
HWY_INLINE Words operator<<(Words a, Words shift) {
    return Words(hn::Shl(a.part, shift.part));
}
/// The words where the mask is true, elsewhere 0.
HWY_INLINE Words masked(const Doubles::Mask& mask, Words a) {
    return Words(hn::IfThenElseZero(hn::RebindMask(Words::Tag(), mask.part[0]), a.part));
}

/// Rounded up.
HWY_INLINE Doubles ceiling(Doubles a) {
    return per_part<Doubles>([&](std::size_t i) { return hn::Ceil(a.part[i]); });
}
/// Rounded down to words. Precondition: 0 <= a < 2^51.
HWY_INLINE Words whole_part(Doubles a) {
    // Added to 2^52, a whole number is the lowest bits of the sum.
    const Words::Tag words;
    const auto sum = hn::Add(hn::Floor(a.part[0]), hn::Set(Doubles::Tag(), 0x1p52));
    return Words(hn::AndNot(hn::Set(words, 0x4330000000000000U), hn::BitCast(words, sum)));
}

/// The coordinates of four points, three numbers each in memory.
struct FourPoints {
    Double4 x, y, z;
};
HWY_INLINE FourPoints load_points(const double* numbers) {
    FourPoints points;
    constexpr std::size_t kStep = Double4::kPartLanes;
    for_each_part<Double4::kParts>([&](std::size_t i) {
        const double* part = numbers + 3 * i * kStep;
        if constexpr (kStep == 1) {
            points.x.part[i] = hn::LoadU(Double4::Tag(), part);
            points.y.part[i] = hn::LoadU(Double4::Tag(), part + 1);
            points.z.part[i] = hn::LoadU(Double4::Tag(), part + 2);
        } else {
            hn::LoadInterleaved3(
                Double4::Tag(), part, points.x.part[i], points.y.part[i], points.z.part[i]);
        }
    });
    return points;
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
