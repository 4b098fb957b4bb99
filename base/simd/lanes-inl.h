// SPDX-License-Identifier: MIT
//
// The vocabulary of wide kernels: fixed numbers of doubles or floats side by side, in one register
// or in several. This folder is the only place that names Highway's operations. A kernel file is
// compiled once per instruction set and starts with
//     #undef HWY_TARGET_INCLUDE
//     #define HWY_TARGET_INCLUDE "earshot/FOLDER/NAME_kernel.cpp"
//     #include <hwy/foreach_target.h>
//     #include "earshot/base/simd/lanes-inl.h"
// It is then included again for every set, which is why each -inl.h has a guard per target and
// includes what it needs itself.
//
// Only mul_add() and neg_mul_add() may fuse a product with a sum. Without them every set computes
// the same bits, provided that min() and max() meet no number that is not one.

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#if defined(EARSHOT_BASE_SIMD_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BASE_SIMD_LANES_INL_H
#undef EARSHOT_BASE_SIMD_LANES_INL_H
#else
#define EARSHOT_BASE_SIMD_LANES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Calls `operation` for the index of every register. Where there is one the compiler never sees a
/// loop, which it might unroll too late to keep the register out of memory.
template <std::size_t kParts, typename Operation>
HWY_INLINE void for_each_part(Operation&& operation) {
    if constexpr (kParts == 1) {
        operation(std::size_t{0});
    } else {
        for (std::size_t i = 0; i < kParts; ++i) {
            operation(i);
        }
    }
}

/// The Lanes or LaneMask of the results of `operation` for every register.
template <typename Result, typename Operation>
HWY_INLINE Result per_part(Operation&& operation) {
    Result result;
    for_each_part<Result::kParts>([&](std::size_t i) { result.part[i] = operation(i); });
    return result;
}

/// The same of the registers of its operands.
template <typename Result, typename Operation, typename... Operands>
HWY_INLINE Result map(const Operation& operation, const Operands&... operands) {
    Result result;
    if constexpr (Result::kParts == 1) {
        result.part[0] = operation(operands.part[0]...);
    } else {
        for (std::size_t i = 0; i < Result::kParts; ++i) {
            result.part[i] = operation(operands.part[i]...);
        }
    }
    return result;
}

/// One truth value per lane.
template <typename Real, std::size_t N>
struct LaneMask {
    using Tag = hn::CappedTag<Real, N>;
    static constexpr std::size_t kPartLanes = hn::MaxLanes(Tag());
    static constexpr std::size_t kParts = N / kPartLanes;

    hn::Mask<Tag> part[kParts];

    /// True in the first `count` lanes.
    HWY_INLINE static LaneMask first(std::size_t count) {
        return per_part<LaneMask>([&](std::size_t i) {
            const std::size_t before = i * kPartLanes;
            return hn::FirstN(Tag(), count > before ? count - before : 0);
        });
    }
};

/// N numbers side by side.
template <typename Real, std::size_t N>
struct Lanes {
    using Mask = LaneMask<Real, N>;
    using Tag = typename Mask::Tag;
    static constexpr std::size_t kCount = N;
    static constexpr std::size_t kPartLanes = Mask::kPartLanes;
    static constexpr std::size_t kParts = Mask::kParts;

    hn::Vec<Tag> part[kParts];

    Lanes() = default;
    /// The same number in every lane.
    HWY_INLINE explicit Lanes(Real value) {
        for_each_part<kParts>([&](std::size_t i) { part[i] = hn::Set(Tag(), value); });
    }

    HWY_INLINE static Lanes load(const Real* aligned) {
        return per_part<Lanes>(
            [&](std::size_t i) { return hn::Load(Tag(), aligned + i * kPartLanes); });
    }
    HWY_INLINE static Lanes load_unaligned(const Real* numbers) {
        return per_part<Lanes>(
            [&](std::size_t i) { return hn::LoadU(Tag(), numbers + i * kPartLanes); });
    }
    HWY_INLINE void store(Real* aligned) const {
        for_each_part<kParts>(
            [&](std::size_t i) { hn::Store(part[i], Tag(), aligned + i * kPartLanes); });
    }
    HWY_INLINE void store_unaligned(Real* numbers) const {
        for_each_part<kParts>(
            [&](std::size_t i) { hn::StoreU(part[i], Tag(), numbers + i * kPartLanes); });
    }
};

/// Two rows of lanes, read from or written to pairs in memory.
template <typename Row>
struct RowPair {
    Row first, second;
};

/// Lane i: numbers 2 i and 2 i + 1.
template <typename Row>
HWY_INLINE RowPair<Row> load_pairs(const double* numbers) {
    constexpr std::size_t kStep = Row::kPartLanes;
    RowPair<Row> pair;
    for_each_part<Row::kParts>([&](std::size_t i) {
        const double* part = numbers + 2 * i * kStep;
        if constexpr (kStep == 1) {
            pair.first.part[i] = hn::LoadU(typename Row::Tag(), part);
            pair.second.part[i] = hn::LoadU(typename Row::Tag(), part + 1);
        } else {
            hn::LoadInterleaved2(
                typename Row::Tag(), part, pair.first.part[i], pair.second.part[i]);
        }
    });
    return pair;
}
template <typename Row>
HWY_INLINE void store_pairs(Row first, Row second, double* numbers) {
    constexpr std::size_t kStep = Row::kPartLanes;
    for_each_part<Row::kParts>([&](std::size_t i) {
        double* part = numbers + 2 * i * kStep;
        if constexpr (kStep == 1) {
            hn::StoreU(first.part[i], typename Row::Tag(), part);
            hn::StoreU(second.part[i], typename Row::Tag(), part + 1);
        } else {
            hn::StoreInterleaved2(first.part[i], second.part[i], typename Row::Tag(), part);
        }
    });
}
/// Numbers 4 i ... 4 i + 3: lane i of each row.
template <typename Row>
HWY_INLINE void store_fours(Row first, Row second, Row third, Row fourth, double* numbers) {
    for_each_part<Row::kParts>([&](std::size_t i) {
        hn::StoreInterleaved4(first.part[i],
                              second.part[i],
                              third.part[i],
                              fourth.part[i],
                              typename Row::Tag(),
                              numbers + 4 * i * Row::kPartLanes);
    });
}
/// The lanes in opposite order.
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> reverse(Lanes<Real, N> a) {
    using Row = Lanes<Real, N>;
    return per_part<Row>([&](std::size_t i) {
        return hn::Reverse(typename Row::Tag(), a.part[Row::kParts - 1 - i]);
    });
}

/// As many doubles as a register holds, at most 8: kernels loop in steps of Doubles::kCount.
using Doubles = Lanes<double, hn::MaxLanes(hn::CappedTag<double, 8>())>;

/// Real and imaginary parts of complex numbers, which lie in pairs in memory.
struct ComplexDoubles {
    Doubles re, im;

    HWY_INLINE static ComplexDoubles load_unaligned(const double* pairs) {
        ComplexDoubles result;
        hn::LoadInterleaved2(Doubles::Tag(), pairs, result.re.part[0], result.im.part[0]);
        return result;
    }
    HWY_INLINE void store_unaligned(double* pairs) const {
        hn::StoreInterleaved2(re.part[0], im.part[0], Doubles::Tag(), pairs);
    }
};
using Double4 = Lanes<double, 4>;
using Float4 = Lanes<float, 4>;
using Float8 = Lanes<float, 8>;
using Float16 = Lanes<float, 16>;

template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> operator+(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<Lanes<Real, N>>([](auto u, auto v) { return hn::Add(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> operator-(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<Lanes<Real, N>>([](auto u, auto v) { return hn::Sub(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> operator*(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<Lanes<Real, N>>([](auto u, auto v) { return hn::Mul(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> operator/(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<Lanes<Real, N>>([](auto u, auto v) { return hn::Div(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> operator-(Lanes<Real, N> a) {
    return map<Lanes<Real, N>>([](auto u) { return hn::Neg(u); }, a);
}
/// a * b + c, fused where the set can.
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> mul_add(Lanes<Real, N> a, Lanes<Real, N> b, Lanes<Real, N> c) {
    return map<Lanes<Real, N>>([](auto u, auto v, auto w) { return hn::MulAdd(u, v, w); }, a, b, c);
}
/// c - a * b, fused where the set can.
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> neg_mul_add(Lanes<Real, N> a, Lanes<Real, N> b, Lanes<Real, N> c) {
    return map<Lanes<Real, N>>(
        [](auto u, auto v, auto w) { return hn::NegMulAdd(u, v, w); }, a, b, c);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> min(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<Lanes<Real, N>>([](auto u, auto v) { return hn::Min(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> max(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<Lanes<Real, N>>([](auto u, auto v) { return hn::Max(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> abs(Lanes<Real, N> a) {
    return map<Lanes<Real, N>>([](auto u) { return hn::Abs(u); }, a);
}

/// The magnitude of one and the sign of another.
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> copy_sign(Lanes<Real, N> magnitude, Lanes<Real, N> sign) {
    return map<Lanes<Real, N>>([](auto u, auto v) { return hn::CopySign(u, v); }, magnitude, sign);
}

// Comparisons are false in lanes that are not a number.

template <typename Real, std::size_t N>
HWY_INLINE LaneMask<Real, N> operator<=(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<LaneMask<Real, N>>([](auto u, auto v) { return hn::Le(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE LaneMask<Real, N> operator<(Lanes<Real, N> a, Lanes<Real, N> b) {
    return map<LaneMask<Real, N>>([](auto u, auto v) { return hn::Lt(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE LaneMask<Real, N> operator&(LaneMask<Real, N> a, LaneMask<Real, N> b) {
    return map<LaneMask<Real, N>>([](auto u, auto v) { return hn::And(u, v); }, a, b);
}
template <typename Real, std::size_t N>
HWY_INLINE LaneMask<Real, N> operator|(LaneMask<Real, N> a, LaneMask<Real, N> b) {
    return map<LaneMask<Real, N>>([](auto u, auto v) { return hn::Or(u, v); }, a, b);
}
/// a and not b.
template <typename Real, std::size_t N>
HWY_INLINE LaneMask<Real, N> and_not(LaneMask<Real, N> a, LaneMask<Real, N> b) {
    return map<LaneMask<Real, N>>([](auto v, auto u) { return hn::AndNot(v, u); }, b, a);
}
template <typename Real, std::size_t N>
HWY_INLINE Lanes<Real, N> select(LaneMask<Real, N> mask, Lanes<Real, N> yes, Lanes<Real, N> no) {
    return map<Lanes<Real, N>>(
        [](auto m, auto y, auto n) { return hn::IfThenElse(m, y, n); }, mask, yes, no);
}
template <typename Real, std::size_t N>
HWY_INLINE LaneMask<Real, N> select(LaneMask<Real, N> mask,
                                    LaneMask<Real, N> yes,
                                    LaneMask<Real, N> no) {
    return (mask & yes) | and_not(no, mask);
}
/// Bit i is lane i.
template <typename Real, std::size_t N>
HWY_INLINE std::uint32_t bits(LaneMask<Real, N> mask) {
    using Mask = LaneMask<Real, N>;
    std::uint32_t result = 0;
    for_each_part<Mask::kParts>([&](std::size_t i) {
        alignas(8) std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(typename Mask::Tag(), mask.part[i], bytes);
        const std::uint32_t part = bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
        result |= part << (i * Mask::kPartLanes);
    });
    return result;
}
/// Whether the mask is true in any lane.
template <typename Real, std::size_t N>
HWY_INLINE bool any(LaneMask<Real, N> mask) {
    return bits(mask) != 0;
}

/// The first lane.
template <typename Real, std::size_t N>
HWY_INLINE Real first_lane(Lanes<Real, N> a) {
    return hn::GetLane(a.part[0]);
}

/// The smallest lane.
template <typename Real, std::size_t N>
HWY_INLINE Real reduce_min(Lanes<Real, N> a) {
    using Tag = typename Lanes<Real, N>::Tag;
    auto smallest = a.part[0];
    for (std::size_t i = 1; i < Lanes<Real, N>::kParts; ++i) {
        smallest = hn::Min(smallest, a.part[i]);
    }
    return hn::GetLane(hn::MinOfLanes(Tag(), smallest));
}
/// The largest lane.
template <typename Real, std::size_t N>
HWY_INLINE Real reduce_max(Lanes<Real, N> a) {
    using Tag = typename Lanes<Real, N>::Tag;
    auto largest = a.part[0];
    for (std::size_t i = 1; i < Lanes<Real, N>::kParts; ++i) {
        largest = hn::Max(largest, a.part[i]);
    }
    return hn::GetLane(hn::MaxOfLanes(Tag(), largest));
}

}  // namespace earshot::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
