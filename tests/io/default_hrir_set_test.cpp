// SPDX-License-Identifier: MIT
#include "earshot/io/default_hrir_set.h"

#include "earshot/audio/binaural.h"
#include "earshot/audio/internal/fft.h"
#include "earshot/audio/late_noise.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

namespace earshot::io {
namespace {

using Direction = std::array<double, 3>;

constexpr double kSpeedOfSound = 343.2;

Direction at(double azimuth_degrees, double elevation_degrees) {
    const double azimuth = azimuth_degrees * std::numbers::pi / 180.0;
    const double elevation = elevation_degrees * std::numbers::pi / 180.0;
    return {std::cos(elevation) * std::cos(azimuth),
            std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

class DefaultHrirSet : public ::testing::Test {
protected:
    void SetUp() override {
        try {
            set = default_hrir_set();
        } catch (const Error&) {
            GTEST_SKIP() << "built without the KEMAR data";
        }
        hrirs.emplace(set);
    }

    // What the ears hear of a source at 2 m, without the 1 / r.
    std::array<audio::ImpulseResponse, 2> source_at(const Direction& towards) const {
        audio::Arrival arrival;
        arrival.delay = 2.0 / kSpeedOfSound;
        arrival.pressure.fill(1.0);
        arrival.direction = {-towards[0], -towards[1], -towards[2]};
        const audio::Assembler assembler(audio::Bands::octaves(), set.sample_rate);
        return render_binaural(assembler, {&arrival, 1}, *hrirs);
    }

    double level_db(const std::vector<double>& samples, double hz) const {
        std::complex<double> sum = 0.0;
        for (std::size_t n = 0; n < samples.size(); ++n) {
            const double turns = hz / set.sample_rate * static_cast<double>(n);
            sum += std::polar(samples[n], -2.0 * std::numbers::pi * turns);
        }
        return 20.0 * std::log10(std::abs(sum));
    }

    audio::HrirSet set;
    std::optional<audio::HrirInterpolator> hrirs;
};

double energy(const std::vector<double>& samples) {
    double sum = 0.0;
    for (const double sample : samples) {
        sum += sample * sample;
    }
    return sum;
}

// ISO 3382-1: less than 20 dB below the largest. Milliseconds.
double onset_ms(const audio::ImpulseResponse& response) {
    double largest = 0.0;
    for (const double sample : response.samples) {
        largest = std::max(largest, std::abs(sample));
    }
    std::size_t n = 0;
    while (std::abs(response.samples[n]) < 0.1 * largest) {
        ++n;
    }
    return 1000.0 * static_cast<double>(n) / response.sample_rate;
}

TEST_F(DefaultHrirSet, HasTheDirectionsOfTheMeasurement) {
    EXPECT_EQ(set.directions.size(), 710U);
    EXPECT_EQ(set.sample_rate, 44100.0);
    EXPECT_NEAR(set.directions[0].distance, 1.4, 1e-12);
}

// A head is small beside the wave: against 1 / r within 1 dB, in front up to 300 Hz, at the side
// up to 150 Hz, where a rigid sphere of its size has 0.5 dB.
TEST_F(DefaultHrirSet, ChangesNothingAtLowFrequencies) {
    const auto front = source_at(at(0.0, 0.0));
    for (double hz = 60.0; hz <= 300.0; hz += 20.0) {
        EXPECT_NEAR(level_db(front[0].samples, hz), 0.0, 0.6) << hz;
        EXPECT_NEAR(level_db(front[1].samples, hz), 0.0, 0.6) << hz;
    }
    for (double azimuth = 0.0; azimuth < 360.0; azimuth += 30.0) {
        for (const double elevation : {-40.0, 0.0, 45.0, 90.0}) {
            const auto ears = source_at(at(azimuth, elevation));
            for (const double hz : {30.0, 60.0, 100.0, 150.0}) {
                EXPECT_NEAR(level_db(ears[0].samples, hz), 0.0, 0.6) << azimuth << " " << hz;
                EXPECT_NEAR(level_db(ears[1].samples, hz), 0.0, 0.6) << azimuth << " " << hz;
            }
        }
    }
}

// Woodworth: at the side the nearer ear hears it a / c = 0.255 ms early, the other one
// (pi / 2) a / c = 0.40 ms late, for a radius of 8.75 cm.
TEST_F(DefaultHrirSet, ArrivesAtTheHeadsCentreInTime) {
    const double expected = 2000.0 / kSpeedOfSound;
    for (const double azimuth : {0.0, 180.0}) {
        const auto ears = source_at(at(azimuth, 0.0));
        EXPECT_NEAR(onset_ms(ears[0]), expected, 0.1);
        EXPECT_NEAR(onset_ms(ears[1]), expected, 0.1);
    }
    const auto left = source_at(at(90.0, 0.0));
    EXPECT_NEAR(onset_ms(left[0]), expected - 0.255, 0.05);
    EXPECT_NEAR(onset_ms(left[1]), expected + 0.40, 0.05);
    const auto right = source_at(at(-90.0, 0.0));
    EXPECT_NEAR(onset_ms(right[1]), expected - 0.255, 0.05);
    EXPECT_NEAR(onset_ms(right[0]), expected + 0.40, 0.05);
}

// The mean over random directions, interpolated ones therefore.
TEST_F(DefaultHrirSet, IsAsLoudInADiffuseFieldAsNoHead) {
    constexpr std::size_t kDirections = 1500;
    const std::array<double, 7> centres{125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0};
    std::array<double, 7> power{};
    for (std::uint64_t i = 0; i < kDirections; ++i) {
        const double sine = random_between(1, 0, i, -1.0, 1.0);
        const double elevation = std::asin(sine) * 180.0 / std::numbers::pi;
        const auto hrir = hrirs->at(at(random_between(1, 1, i, 0.0, 360.0), elevation));
        for (std::size_t band = 0; band < centres.size(); ++band) {
            const double hz = centres[band] * std::pow(2.0, random_between(1, 2, i, -0.5, 0.5));
            for (const auto& ear : hrir.ears) {
                power[band] += std::pow(10.0, level_db(ear, hz) / 10.0);
            }
        }
    }
    for (std::size_t band = 0; band < centres.size(); ++band) {
        EXPECT_NEAR(10.0 * std::log10(power[band] / (2.0 * kDirections)), 0.0, 0.5)
            << centres[band];
    }
}

// Late noise of equal energy from everywhere, an energy of 1 per millisecond and octave: each ear
// has the level of no head. Four seconds have 700 independent values in the octave of 125 Hz.
TEST_F(DefaultHrirSet, GivesLateNoiseTheLevelOfMono) {
    const audio::Bands& bands = audio::Bands::octaves();
    audio::EnergyHistogram histogram;
    histogram.energy.resize(4000);
    histogram.directions.resize(histogram.energy.size() / audio::kBinsPerSpan);
    for (audio::Spectrum& bin : histogram.energy) {
        bin.fill(1.0);
    }
    for (auto& span : histogram.directions) {
        for (audio::Spectrum& part : span) {
            part.fill(static_cast<double>(audio::kBinsPerSpan) / audio::kDirectionParts);
        }
    }
    const auto ears = audio::binaural_late_noise(bands, histogram, *hrirs, 1);
    const audio::RealFft fft(audio::power_of_two_from(ears[0].size()));
    std::vector<std::complex<double>> spectrum(fft.bins());
    for (const double centre : {125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0}) {
        double mean = 0.0;
        double count = 0.0;
        for (std::vector<double> ear : ears) {
            ear.resize(fft.size(), 0.0);
            fft.forward(ear, spectrum);
            for (std::size_t k = 0; k < fft.bins(); ++k) {
                const double hz =
                    static_cast<double>(k) * set.sample_rate / static_cast<double>(fft.size());
                if (hz > centre / std::sqrt(2.0) && hz < centre * std::sqrt(2.0)) {
                    mean += std::norm(spectrum[k]);
                    count += 1.0;
                }
            }
        }
        // The energy of an arrival of pressure 1 is that of one sample, whose |spectrum| is 1.
        EXPECT_NEAR(10.0 * std::log10(mean / count / 4000.0), 0.0, 0.5) << centre;
    }
}

// In steps of a degree round the head neither ear's level nor its delay moves by more than between
// the measured neighbours, 5 degrees apart.
TEST_F(DefaultHrirSet, StepsNoMoreThanTheMeasuredSet) {
    const auto level = [&](double azimuth, std::size_t ear) {
        return 10.0 * std::log10(energy(hrirs->at(at(azimuth, 0.0)).ears[ear]));
    };
    for (double cell = 0.0; cell < 360.0; cell += 5.0) {
        for (std::size_t ear = 0; ear < 2; ++ear) {
            const double begin = level(cell, ear);
            const double step = std::abs(level(cell + 5.0, ear) - begin);
            double before = begin;
            for (double azimuth = cell + 1.0; azimuth <= cell + 5.0; azimuth += 1.0) {
                const double next = level(azimuth, ear);
                EXPECT_LT(std::abs(next - before), std::max(step, 0.5)) << azimuth;
                before = next;
            }
        }
    }
}

// Directions left out of the set come back from their neighbours: every other azimuth, 10 degrees
// apart then.
TEST_F(DefaultHrirSet, RecoversDirectionsThatAreLeftOut) {
    audio::HrirSet half = set;
    half.directions.clear();
    std::vector<audio::Hrir> left_out;
    for (std::size_t i = 0; i < set.directions.size(); ++i) {
        const bool horizontal = std::abs(set.directions[i].towards[2]) < 1e-9;
        (horizontal && i % 2 == 1 ? left_out : half.directions).push_back(set.directions[i]);
    }
    ASSERT_EQ(left_out.size(), 36U);
    const audio::HrirInterpolator interpolator(half);
    double interpolated = 0.0;  // sums of squared errors in decibels
    double closest = 0.0;
    for (const audio::Hrir& measured : left_out) {
        const auto hrir = interpolator.at(measured.towards);
        const audio::Hrir& neighbour = half.directions[closest_direction(half, measured.towards)];
        for (std::size_t ear = 0; ear < 2; ++ear) {
            const auto& expected = ear == 0 ? measured.left : measured.right;
            const auto& other = ear == 0 ? neighbour.left : neighbour.right;
            for (const double hz : {250.0, 500.0, 1000.0, 2000.0, 4000.0}) {
                const double level = level_db(expected, hz);
                interpolated += std::pow(level_db(hrir.ears[ear], hz) - level, 2.0);
                closest += std::pow(level_db(other, hz) - level, 2.0);
            }
        }
    }
    const double count = 36.0 * 2.0 * 5.0;
    RecordProperty("error_db", std::to_string(std::sqrt(interpolated / count)));
    RecordProperty("error_of_closest_db", std::to_string(std::sqrt(closest / count)));
    EXPECT_LT(std::sqrt(interpolated / count), 0.8);
    EXPECT_LT(interpolated, 0.5 * closest);
}

}  // namespace
}  // namespace earshot::io
