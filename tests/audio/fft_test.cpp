// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/fft.h"

#include "earshot/base/digest.h"
#include "earshot/base/random.h"
#include "earshot/base/simd.h"

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

/// All sizes up to a limit, each order of passes among them.
std::vector<std::size_t> sizes_up_to(std::size_t limit) {
    std::vector<std::size_t> sizes;
    for (std::size_t size = fft_size_from(1); size <= limit; size = fft_size_from(size + 1)) {
        sizes.push_back(size);
    }
    return sizes;
}

TEST(RealFft, EqualsTheDefiningSum) {
    for (const std::size_t size : sizes_up_to(1280)) {
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

TEST(RealFft, OfLargeSizesEqualsTheDefiningSumAtSomeBins) {
    for (const std::size_t size : {4096U, 8192U, 16384U, 65536U, 81920U, 98304U, 131072U}) {
        const auto signal = noise(size, size);
        const RealFft fft(size);
        std::vector<Complex> spectrum(fft.bins());
        fft.forward(signal, spectrum);
        for (const std::size_t k : {std::size_t{1}, size / 8 + 5, size / 3, size / 2 - 1}) {
            EXPECT_LT(std::abs(spectrum[k] - brute_force_bin(signal, k)), 1e-11)
                << "size " << size << " bin " << k;
        }
    }
}

TEST(RealFft, InverseUndoesForward) {
    std::vector<std::size_t> sizes = sizes_up_to(4096);
    sizes.insert(sizes.end(), {32768, 81920, 98304, 131072});
    FftWorkspace workspace;
    for (const std::size_t size : sizes) {
        const auto signal = noise(size, 7);
        const RealFft fft(size);
        std::vector<Complex> spectrum(fft.bins());
        std::vector<double> back(size);
        fft.forward(signal, spectrum, workspace);
        fft.inverse(spectrum, back, workspace);
        for (std::size_t n = 0; n < size; ++n) {
            ASSERT_NEAR(back[n], signal[n], 1e-14) << "size " << size << " sample " << n;
        }
    }
}

TEST(RealFft, FilteredInverseIsTheInverseOfTheProduct) {
    FftWorkspace workspace;
    for (const std::size_t size : {4U, 24U, 80U, 256U, 1536U}) {
        const auto signal = noise(size, 3);
        const RealFft fft(size);
        const std::vector<double> gains = noise(fft.bins(), 4);
        std::vector<Complex> spectrum(fft.bins());
        fft.forward(signal, spectrum);
        std::vector<double> at_once(size);
        fft.filtered_inverse(spectrum, gains, at_once, workspace);
        for (std::size_t k = 0; k < fft.bins(); ++k) {
            spectrum[k] *= gains[k];
        }
        std::vector<double> in_steps(size);
        fft.inverse(spectrum, in_steps);
        EXPECT_EQ(at_once, in_steps) << size;
    }
}

/// Of the spectra of noise and of what the inverse makes of them.
std::uint64_t digest_of_transforms() {
    Digest digest;
    for (const std::size_t size : {8U, 20U, 64U, 96U, 160U, 1280U, 4096U, 6144U, 81920U}) {
        const RealFft fft(size);
        const auto signal = noise(fft.size(), 1);
        std::vector<Complex> spectrum(fft.bins());
        std::vector<double> back(fft.size());
        fft.forward(signal, spectrum);
        fft.inverse(spectrum, back);
        for (const Complex& bin : spectrum) {
            digest.add(bin.real());
            digest.add(bin.imag());
        }
        for (const double sample : back) {
            digest.add(sample);
        }
    }
    return digest.value();
}

// Every instruction set, and with it every CPU (docs/determinism.md).
TEST(RealFft, HasTheSameBitsWithEveryInstructionSet) {
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        EXPECT_EQ(digest_of_transforms(), 11989140935096942868ULL) << target;
    }
    override_simd_target("auto");
}

TEST(RealFft, PowersOfTwoAreRoundedUp) {
    EXPECT_EQ(power_of_two_from(1), 1U);
    EXPECT_EQ(power_of_two_from(4096), 4096U);
    EXPECT_EQ(power_of_two_from(4097), 8192U);
}

TEST(RealFft, SizesAreThoseWithAtMostOneFactorOfThreeOrFive) {
    EXPECT_EQ(sizes_up_to(100),
              (std::vector<std::size_t>{4, 8, 12, 16, 20, 24, 32, 40, 48, 64, 80, 96}));
    EXPECT_EQ(fft_size_from(1), 4U);
    EXPECT_EQ(fft_size_from(73852), 81920U);
    EXPECT_EQ(fft_size_from(81921), 98304U);
    EXPECT_EQ(fft_size_from(98305), 131072U);
}

}  // namespace
}  // namespace earshot::audio
