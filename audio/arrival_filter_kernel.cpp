// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/arrival_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "earshot/audio/arrival_filter_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file again for every instruction set.
#include "earshot/base/simd/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace earshot::audio::HWY_NAMESPACE {

using namespace earshot::HWY_NAMESPACE;

void logarithms(double* values, std::size_t count) {
    for (std::size_t i = 0; i < count; i += Doubles::kCount) {
        log(Doubles::load(values + i)).store(values + i);
    }
}

// Linear between the band centres. The last step of a segment may pass its end: the next segment
// writes over that.
void interpolate_logarithms(const FilterRows& rows, const double* log_pressure, double* out) {
    for (const FilterSegment& segment : rows.segments) {
        const double lower = log_pressure[segment.lower_band];
        const Doubles rise(log_pressure[segment.lower_band + 1] - lower);
        for (std::size_t k = segment.begin; k < segment.end; k += Doubles::kCount) {
            const Doubles weight = Doubles::load_unaligned(rows.upper_weight + k);
            (Doubles(lower) + weight * rise).store_unaligned(out + k);
        }
    }
}

void filter_spectrum(const FilterRows& rows,
                     const double* log_pressure,
                     double* log_magnitude,
                     double* spectrum) {
    interpolate_logarithms(rows, log_pressure, log_magnitude);
    for (std::size_t k = 0; k < rows.stride; k += Doubles::kCount) {
        Doubles phase(0.0);
        for (std::size_t band = 0; band < rows.bands; ++band) {
            const Doubles row = Doubles::load(rows.phase_of_band + band * rows.stride + k);
            phase = phase + Doubles(log_pressure[band]) * row;
        }
        const Doubles magnitude = exp(Doubles::load(log_magnitude + k));
        const SinCos turn = sin_cos(phase);
        const ComplexDoubles value{magnitude * turn.cos, magnitude * turn.sin};
        value.store_unaligned(spectrum + 2 * k);
    }
}

void delay_spectrum(const SpectralDelay& delay,
                    const double* angle,
                    const double* kernel,
                    std::size_t count,
                    double* spectrum) {
    const ComplexDoubles sum{Doubles(delay.sum.real()), Doubles(delay.sum.imag())};
    const ComplexDoubles part{Doubles(delay.difference.real()), Doubles(delay.difference.imag())};
    for (std::size_t k = 0; k < count; k += Doubles::kCount) {
        const Doubles difference = Doubles::load(kernel + k);
        const ComplexDoubles factor{sum.re + difference * part.re, sum.im + difference * part.im};
        const SinCos turn = sin_cos(-(Doubles(delay.delay) * Doubles::load(angle + k)));
        const ComplexDoubles turned{factor.re * turn.cos - factor.im * turn.sin,
                                    factor.re * turn.sin + factor.im * turn.cos};
        const ComplexDoubles value = ComplexDoubles::load_unaligned(spectrum + 2 * k);
        const ComplexDoubles product{value.re * turned.re - value.im * turned.im,
                                     value.re * turned.im + value.im * turned.re};
        product.store_unaligned(spectrum + 2 * k);
    }
}

}  // namespace earshot::audio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace earshot::audio {

HWY_EXPORT(logarithms);
HWY_EXPORT(filter_spectrum);
HWY_EXPORT(delay_spectrum);

void logarithms(double* values, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(logarithms)(values, count);
}

void filter_spectrum(const FilterRows& rows,
                     const double* log_pressure,
                     double* log_magnitude,
                     double* spectrum) {
    HWY_DYNAMIC_DISPATCH(filter_spectrum)(rows, log_pressure, log_magnitude, spectrum);
}

void delay_spectrum(const SpectralDelay& delay,
                    const double* angle,
                    const double* kernel,
                    std::size_t count,
                    double* spectrum) {
    HWY_DYNAMIC_DISPATCH(delay_spectrum)(delay, angle, kernel, count, spectrum);
}

}  // namespace earshot::audio
#endif
