// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fft.h"

#include "earshot/base/digest.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace earshot::audio {
namespace {

using Complex = std::complex<double>;

std::vector<double> noise(std::size_t size, std::uint64_t seed) {
    std::vector<double> signal(size);
    for (std::size_t n = 0; n < size; ++n) {
        signal[n] = random_between(seed, 0, n, -1.0, 1.0);
    }
    return signal;
}

// The definition, summed term by term in long double.
Complex brute_force_bin(const std::vector<double>& signal, std::size_t k) {
    std::complex<long double> sum = 0;
    const auto size = signal.size();
    for (std::size_t n = 0; n < size; ++n) {
        const long double angle = -2 * std::numbers::pi_v<long double> *
                                  static_cast<long double>(n * k % size) /
                                  static_cast<long double>(size);
        sum += static_cast<long double>(signal[n]) *
               std::complex<long double>(std::cos(angle), std::sin(angle));
    }
    return {static_cast<double>(sum.real()), static_cast<double>(sum.imag())};
}

TEST(RealFft, EqualsTheDefiningSum) {
    for (const std::size_t size : {4U, 8U, 16U, 32U, 256U, 512U}) {
        const auto signal = noise(size, size);
        const RealFft fft(size);
        std::vector<Complex> spectrum(fft.bins());
        fft.forward(signal, spectrum);
        for (std::size_t k = 0; k < fft.bins(); ++k) {
            // Rounding grows with sqrt(size) log(size); 1e-13 is some ten times that.
            EXPECT_LT(std::abs(spectrum[k] - brute_force_bin(signal, k)), 1e-13)
                << "size " << size << " bin " << k;
        }
    }
}

TEST(RealFft, InverseUndoesForward) {
    for (const std::size_t size : {4U, 8U, 1024U, 32768U}) {
        const auto signal = noise(size, 7);
        const RealFft fft(size);
        std::vector<Complex> spectrum(fft.bins());
        std::vector<double> back(size);
        fft.forward(signal, spectrum);
        fft.inverse(spectrum, back);
        for (std::size_t n = 0; n < size; ++n) {
            ASSERT_NEAR(back[n], signal[n], 1e-14) << "size " << size << " sample " << n;
        }
    }
}

// The bits on a machine with fused multiply-add; run again with the feature masked
// (docs/determinism.md), this must not change.
TEST(RealFft, HasTheSameBitsOnEveryMachine) {
    const RealFft fft(4096);
    const auto signal = noise(fft.size(), 1);
    std::vector<Complex> spectrum(fft.bins());
    std::vector<double> back(fft.size());
    fft.forward(signal, spectrum);
    fft.inverse(spectrum, back);
    Digest digest;
    for (const Complex& bin : spectrum) {
        digest.add(bin.real());
        digest.add(bin.imag());
    }
    for (const double sample : back) {
        digest.add(sample);
    }
    EXPECT_EQ(digest.value(), 11142941547332706207ULL);
}

TEST(RealFft, PowersOfTwoAreRoundedUp) {
    EXPECT_EQ(power_of_two_from(1), 1U);
    EXPECT_EQ(power_of_two_from(4096), 4096U);
    EXPECT_EQ(power_of_two_from(4097), 8192U);
}

}  // namespace
}  // namespace earshot::audio
