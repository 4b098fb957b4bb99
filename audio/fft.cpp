// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fft.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <kissfft/kissfft.hh>

#include <bit>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;
using Kiss = kissfft<double>;

// KISS FFT fills its twiddle factors with std::exp, whose last bits depend on the CPU, and offers
// no way to hand it others. A template argument of an explicit instantiation may name a private
// member
// ([temp.spec.general]/6), and a friend defined in that template carries the access out.
std::vector<Complex>& twiddles_of(Kiss& plan);

template <std::vector<Complex> Kiss::*Twiddles>
struct TwiddleAccess {
    friend std::vector<Complex>& twiddles_of(Kiss& plan) { return plan.*Twiddles; }
};
template struct TwiddleAccess<&Kiss::_twiddles>;

// exp(-2 pi i k / size) for k < count, by the scalar functions that have the same bits everywhere.
std::vector<Complex> unit_circle(std::size_t size, std::size_t count) {
    std::vector<Complex> points(count);
    for (std::size_t k = 0; k < count; ++k) {
        const double angle = 2.0 * math::kPi * static_cast<double>(k) / static_cast<double>(size);
        points[k] = {math::cos(angle), -math::sin(angle)};
    }
    return points;
}

Kiss plan_with(const std::vector<Complex>& twiddles, bool inverse) {
    Kiss plan(twiddles.size(), inverse);
    std::vector<Complex>& own = twiddles_of(plan);
    for (std::size_t k = 0; k < own.size(); ++k) {
        own[k] = inverse ? std::conj(twiddles[k]) : twiddles[k];
    }
    return plan;
}

// std::complex's operator* checks for NaN and may call a library function; this is the bare
// product.
Complex product(const Complex& a, const Complex& b) noexcept {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

struct RealFft::Plans {
    explicit Plans(const std::vector<Complex>& twiddles)
        : forward(plan_with(twiddles, false)), inverse(plan_with(twiddles, true)) {}
    Kiss forward, inverse;
};

RealFft::RealFft(std::size_t size) : size_(size), half_turn_(unit_circle(size, size / 2)) {
    EARSHOT_ASSERT(size >= 4 && std::has_single_bit(size));
    plans_ = std::make_unique<const Plans>(unit_circle(size / 2, size / 2));
}

RealFft::~RealFft() = default;
RealFft::RealFft(RealFft&&) noexcept = default;
RealFft& RealFft::operator=(RealFft&&) noexcept = default;

// Even samples are transformed as real parts and odd ones as imaginary parts of a complex signal of
// half the size; with E and O the transforms of the even and the odd samples, X = E + w O.
void RealFft::forward(std::span<const double> signal, std::span<Complex> spectrum) const {
    EARSHOT_ASSERT(signal.size() == size_ && spectrum.size() == bins());
    const std::size_t half = size_ / 2;
    // std::complex<double> is layout-compatible with two doubles ([complex.numbers]/4), and KISS
    // FFT reads pairs in place like this itself.
    plans_->forward.transform(reinterpret_cast<const Complex*>(signal.data()), spectrum.data());

    const Complex first = spectrum[0];
    spectrum[0] = {first.real() + first.imag(), 0.0};
    spectrum[half] = {first.real() - first.imag(), 0.0};
    for (std::size_t k = 1; k <= half / 2; ++k) {
        const Complex a = spectrum[k];
        const Complex b = std::conj(spectrum[half - k]);
        const Complex even = 0.5 * (a + b);
        const Complex odd = product({0.0, -0.5}, a - b);
        const Complex turned = product(half_turn_[k], odd);
        spectrum[k] = even + turned;
        spectrum[half - k] = std::conj(even - turned);
    }
}

void RealFft::inverse(std::span<const Complex> spectrum, std::span<double> signal) const {
    EARSHOT_ASSERT(signal.size() == size_ && spectrum.size() == bins());
    const std::size_t half = size_ / 2;
    const double scale = 1.0 / static_cast<double>(size_);  // a power of two: exact

    std::vector<Complex> packed(half);
    const double first = spectrum[0].real();
    const double last = spectrum[half].real();
    packed[0] = {scale * (first + last), scale * (first - last)};
    for (std::size_t k = 1; k < half; ++k) {
        const Complex a = spectrum[k];
        const Complex b = std::conj(spectrum[half - k]);
        const Complex turned = product(std::conj(half_turn_[k]), a - b);
        packed[k] = scale * Complex(a.real() + b.real() - turned.imag(),
                                    a.imag() + b.imag() + turned.real());
    }
    plans_->inverse.transform(packed.data(), reinterpret_cast<Complex*>(signal.data()));
}

std::size_t power_of_two_from(std::size_t min_size) noexcept {
    return std::bit_ceil(min_size);
}

}  // namespace earshot::audio
