// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/arrival_filter.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace earshot::audio {
namespace {

using Complex = std::complex<double>;

// Absorption 0 ... 0.75 per reflection, three reflections: what paths in rooms look like.
Spectrum room_spectrum(const Bands& bands, std::uint64_t seed) {
    Spectrum pressure{};
    for (std::size_t b = 0; b < bands.count(); ++b) {
        pressure[b] = std::pow(random_between(seed, 0, b, 0.5, 1.0), 3.0);
    }
    return pressure;
}

// Linear over log-frequency, written out again.
double expected_log_magnitude(const Spectrum& pressure,
                              std::span<const double> centres,
                              double frequency) {
    if (frequency <= centres.front()) {
        return std::log(pressure[0]);
    }
    for (std::size_t b = 0; b + 1 < centres.size(); ++b) {
        if (frequency <= centres[b + 1]) {
            const double along = (std::log(frequency) - std::log(centres[b])) /
                                 (std::log(centres[b + 1]) - std::log(centres[b]));
            return (1 - along) * std::log(pressure[b]) + along * std::log(pressure[b + 1]);
        }
    }
    return std::log(pressure[centres.size() - 1]);
}

// Minimum phase of the whole log-magnitude at once on a grid 32 times as fine.
std::vector<double> expected_phase(const ArrivalFilter& filter,
                                   const Spectrum& pressure,
                                   std::span<const double> centres,
                                   double sample_rate) {
    constexpr std::size_t finer = 32;
    const RealFft fine(finer * filter.fft().size());
    std::vector<Complex> spectrum(fine.bins());
    for (std::size_t k = 0; k < fine.bins(); ++k) {
        const double frequency =
            sample_rate * static_cast<double>(k) / static_cast<double>(fine.size());
        spectrum[k] = expected_log_magnitude(pressure, centres, frequency);
    }
    std::vector<double> cepstrum(fine.size());
    fine.inverse(spectrum, cepstrum);
    for (std::size_t n = 1; n < fine.size(); ++n) {
        cepstrum[n] *= n < fine.size() / 2 ? 2.0 : n == fine.size() / 2 ? 1.0 : 0.0;
    }
    fine.forward(cepstrum, spectrum);
    std::vector<double> phase(filter.fft().bins());
    for (std::size_t k = 0; k < phase.size(); ++k) {
        phase[k] = spectrum[finer * k].imag();
    }
    return phase;
}

void expect_minimum_phase(const Bands& bands, double sample_rate) {
    const ArrivalFilter filter(bands, sample_rate);
    const auto centres = bands.exact_hz().first(filter.bands_in_use());
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Spectrum pressure = room_spectrum(bands, seed);
        std::vector<Complex> spectrum(filter.fft().bins());
        filter.response(pressure, spectrum);
        const auto phase = expected_phase(filter, pressure, centres, sample_rate);
        double worst = 0.0;
        for (std::size_t k = 0; k < spectrum.size(); ++k) {
            const double frequency =
                sample_rate * static_cast<double>(k) / static_cast<double>(filter.fft().size());
            const double magnitude = std::exp(expected_log_magnitude(pressure, centres, frequency));
            EXPECT_NEAR(std::abs(spectrum[k]) / magnitude, 1.0, 1e-12) << "bin " << k;
            worst = std::max(worst, std::abs(spectrum[k] / std::polar(magnitude, phase[k]) - 1.0));
        }
        // What the finer grid of the phases leaves of the cepstrum's aliasing.
        EXPECT_LT(worst, 0.02) << "seed " << seed;
    }
}

TEST(ArrivalFilter, IsMinimumPhaseInOctaves) {
    expect_minimum_phase(Bands::octaves(), 48000.0);
}

TEST(ArrivalFilter, IsMinimumPhaseInThirds) {
    expect_minimum_phase(Bands::third_octaves(), 48000.0);
}

TEST(ArrivalFilter, IsMinimumPhaseAtLowSampleRates) {
    expect_minimum_phase(Bands::octaves(), 1000.0);
}

TEST(ArrivalFilter, IgnoresBandsFromHalfTheSampleRateUp) {
    EXPECT_EQ(ArrivalFilter(Bands::octaves(), 48000.0).bands_in_use(), 10U);
    EXPECT_EQ(ArrivalFilter(Bands::octaves(), 16000.0).bands_in_use(), 9U);
    EXPECT_EQ(ArrivalFilter(Bands::octaves(), 1000.0).bands_in_use(), 4U);
    EXPECT_EQ(ArrivalFilter(Bands::octaves(), 1002.0).bands_in_use(), 4U);
    EXPECT_EQ(ArrivalFilter(Bands::octaves(), 1003.0).bands_in_use(), 5U);
}

// The ringing that does not fit the filter's length folds back onto its beginning; what stands in
// the last tenth tells how much that is.
TEST(ArrivalFilter, HasRungOutAtItsEnd) {
    const Bands& bands = Bands::octaves();
    const ArrivalFilter filter(bands, 48000.0);
    std::vector<Complex> spectrum(filter.fft().bins());
    std::vector<double> ringing(filter.fft().size());
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        filter.response(room_spectrum(bands, seed), spectrum);
        filter.fft().inverse(spectrum, ringing);
        double all = 0.0, end = 0.0;
        for (std::size_t n = 0; n < ringing.size(); ++n) {
            all += ringing[n] * ringing[n];
            end += n >= ringing.size() * 9 / 10 ? ringing[n] * ringing[n] : 0.0;
        }
        EXPECT_LT(end, 2e-6 * all) << "seed " << seed;
    }
}

TEST(ArrivalFilter, TakesSilentBandsToTheFloor) {
    const Bands& bands = Bands::octaves();
    const ArrivalFilter filter(bands, 48000.0);
    Spectrum pressure{};
    pressure[5] = 2.0;
    std::vector<Complex> spectrum(filter.fft().bins());
    filter.response(pressure, spectrum);
    EXPECT_NEAR(std::abs(spectrum[0]), 2.0 * kPressureFloor, 1e-20);
    double largest = 0.0;
    for (const Complex& bin : spectrum) {
        largest = std::max(largest, std::abs(bin));
    }
    EXPECT_LE(largest, 2.0 * (1 + 1e-12));
    EXPECT_GT(largest, 1.7);
}

}  // namespace
}  // namespace earshot::audio
