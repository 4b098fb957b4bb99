// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/modulation_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/modulation_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/audio/kernels/eight_sums-inl.h"
#include "earshot/base/simd/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

/// Rotations by which sines and cosines are carried on before they are computed anew: what they
/// lose by it stays below 1e-14.
constexpr std::size_t kRotations = 64;

/// The partial sums of some of the eight lanes.
struct PartialSums {
    Doubles in_phase[kModulationBands];
    Doubles in_quadrature[kModulationBands];
};

/// Adds the lanes from `first` on of the eight of each step, up to kRotations steps.
HWY_INLINE void add_block(const std::array<const double*, kModulationBands>& energy,
                          std::size_t begin,
                          std::size_t end,
                          double angle,
                          Doubles lanes,
                          PartialSums& sums) {
    const SinCos step = sin_cos(Doubles(8.0 * angle));
    SinCos at = sin_cos(Doubles(angle) * (lanes + Doubles(static_cast<double>(begin))));
    for (std::size_t n = begin; n < end; n += 8) {
        for (std::size_t band = 0; band < kModulationBands; ++band) {
            const Doubles e = Doubles::load_unaligned(energy[band] + n);
            sums.in_phase[band] = sums.in_phase[band] + e * at.cos;
            sums.in_quadrature[band] = sums.in_quadrature[band] + e * at.sin;
        }
        const Doubles cos = at.cos * step.cos - at.sin * step.sin;
        at.sin = at.sin * step.cos + at.cos * step.sin;
        at.cos = cos;
    }
}

std::array<FourierSum, kModulationBands> fourier(
    const std::array<const double*, kModulationBands>& energy, std::size_t length, double angle) {
    alignas(64) double numbers[8];
    lane_numbers().store(numbers);
    alignas(64) double in_phase[kModulationBands][8];
    alignas(64) double in_quadrature[kModulationBands][8];
    for (std::size_t first = 0; first < 8; first += Doubles::kCount) {
        PartialSums sums;
        std::fill(sums.in_phase, sums.in_phase + kModulationBands, Doubles(0.0));
        std::fill(sums.in_quadrature, sums.in_quadrature + kModulationBands, Doubles(0.0));
        std::array<const double*, kModulationBands> part = energy;
        for (const double*& row : part) {
            row += first;
        }
        const Doubles lanes = Doubles::load(numbers + first);
        for (std::size_t begin = 0; begin < length; begin += 8 * kRotations) {
            add_block(part, begin, std::min(length, begin + 8 * kRotations), angle, lanes, sums);
        }
        for (std::size_t band = 0; band < kModulationBands; ++band) {
            sums.in_phase[band].store(in_phase[band] + first);
            sums.in_quadrature[band].store(in_quadrature[band] + first);
        }
    }
    std::array<FourierSum, kModulationBands> result;
    for (std::size_t band = 0; band < kModulationBands; ++band) {
        result[band] = {total(Eight::load(in_phase[band])),
                        total(Eight::load(in_quadrature[band]))};
    }
    return result;
}

void sum_rows(const double* rows, const double* factors, std::size_t count, double* sums) {
    for (std::size_t i = 0; i < kSumRow; i += Doubles::kCount) {
        Doubles sum = Doubles::load_unaligned(sums + i);
        for (std::size_t k = 0; k < count; ++k) {
            sum = sum + Doubles(factors[k]) * Doubles::load_unaligned(rows + kSumRow * k + i);
        }
        sum.store_unaligned(sums + i);
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(fourier);
HWY_EXPORT(sum_rows);

std::array<FourierSum, kModulationBands> fourier_sums(
    const std::array<const double*, kModulationBands>& energy, std::size_t length, double angle) {
    return HWY_DYNAMIC_DISPATCH(fourier)(energy, length, angle);
}

void add_rows(std::span<const double> rows,
              std::span<const double> factors,
              std::span<double, kSumRow> sums) {
    HWY_DYNAMIC_DISPATCH(sum_rows)(rows.data(), factors.data(), factors.size(), sums.data());
}

}  // namespace earshot::audio
#endif
