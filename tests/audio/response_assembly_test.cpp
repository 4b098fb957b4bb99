// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/response_assembly.h"

#include "earshot/audio/binaural.h"
#include "earshot/audio/internal/signal_kernel.h"
#include "earshot/audio/spatial.h"
#include "earshot/base/random.h"
#include "earshot/base/simd.h"

#include <gtest/gtest.h>

#include "support/arrival_reference.h"
#include "support/box_arrivals.h"
#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <string>
#include <vector>

namespace earshot::audio {
namespace {

using support::box_arrivals;
using support::wall_factors;

constexpr double kRate = 48000.0;
constexpr std::size_t kFilterSize = 4096;

const support::ArrivalReference& reference() {
    static const support::ArrivalReference instance = [] {
        const auto centres = Bands::octaves().exact_hz();
        return support::ArrivalReference({centres.begin(), centres.end()}, kRate, kFilterSize);
    }();
    return instance;
}

const Assembler& assembler() {
    static const Assembler instance(Bands::octaves(), kRate);
    return instance;
}

/// Pressures that have nothing to do with each other, 0.125 to 1.
std::vector<Arrival> wild_arrivals(std::size_t count, std::uint64_t seed) {
    std::vector<Arrival> arrivals(count);
    for (std::size_t i = 0; i < count; ++i) {
        arrivals[i].delay = random_between(seed, 0, i, 0.002, 0.1);
        arrivals[i].is_inverted = random(seed, 1, i) < 0.5;
        for (std::size_t band = 0; band < 10; ++band) {
            arrivals[i].pressure[band] = random_between(seed, 2 + band, i, 0.125, 1.0);
        }
    }
    return arrivals;
}

void expect_near_reference(const std::vector<Arrival>& arrivals) {
    const ImpulseResponse found = assembler().assemble(arrivals);
    const std::vector<double> gains(arrivals.size(), 1.0);
    const auto error = support::response_error(
        found.samples, reference().sum(arrivals, gains, found.samples.size()));
    EXPECT_LT(error.energy_db, -100.0);
    EXPECT_LT(error.peak_db, -100.0);
}

// The bound that docs/algorithms/audio.md states, against arrivals that are filtered one by one.
TEST(ResponseAssembly, OfARoomOfOneMaterialIsTheSumOfItsArrivals) {
    expect_near_reference(box_arrivals(7, wall_factors(true)));
}

TEST(ResponseAssembly, OfARoomOfSixMaterialsIsTheSumOfItsArrivals) {
    expect_near_reference(box_arrivals(7, wall_factors(false)));
}

TEST(ResponseAssembly, OfUnrelatedSpectraIsTheSumOfItsArrivals) {
    for (const std::size_t count : {1U, 5U, 40U, 400U}) {
        SCOPED_TRACE(count);
        expect_near_reference(wild_arrivals(count, count));
    }
}

// Bands of no pressure stand 200 dB below the others, which makes filters as steep as they get.
TEST(ResponseAssembly, OfArrivalsInSingleBandsIsTheirSum) {
    std::vector<Arrival> arrivals(120);
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        arrivals[i].delay = 0.002 + 0.0005 * static_cast<double>(i);
        arrivals[i].pressure[i % 10] = 1.0;
    }
    expect_near_reference(arrivals);
}

TEST(ResponseAssembly, WeightsChannelsByTheirGains) {
    const auto arrivals = box_arrivals(6, wall_factors(false));
    std::vector<double> gains(3 * arrivals.size());
    for (std::size_t i = 0; i < gains.size(); ++i) {
        gains[i] = random_between(4, 0, i, -1.0, 1.0);
    }
    const auto channels = assembler().assemble_channels(arrivals, gains, 3);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<double> of_channel(arrivals.size());
        for (std::size_t i = 0; i < arrivals.size(); ++i) {
            of_channel[i] = gains[3 * i + channel];
        }
        const auto& samples = channels[channel].samples;
        const auto error =
            support::response_error(samples, reference().sum(arrivals, of_channel, samples.size()));
        EXPECT_LT(error.energy_db, -100.0) << channel;
        // To the bit what it is alone.
        EXPECT_EQ(assembler().assemble_channels(arrivals, of_channel, 1).front().samples, samples);
    }
}

TEST(ResponseAssembly, HasTheSameBitsOnEveryInstructionSetAndAnyThreads) {
    auto arrivals = box_arrivals(7, wall_factors(false));
    const auto wild = wild_arrivals(60, 9);
    arrivals.insert(arrivals.end(), wild.begin(), wild.end());
    arrivals[3].pressure.fill(0.25);
    arrivals[4].delay = 3.3e-4;  // no room for its ringing
    const std::vector<double> expected = assembler().assemble(arrivals).samples;
    Executor two(2);
    EXPECT_EQ(assembler().assemble(arrivals, 0.0, two).samples, expected);
    for (const std::string& target : simd_targets()) {
        override_simd_target(target);
        EXPECT_EQ(Assembler(Bands::octaves(), kRate).assemble(arrivals).samples, expected)
            << target;
    }
    override_simd_target("auto");
}

TEST(ResponseAssembly, KeepsWhatIsBeforeTheEndOfAFixedLength) {
    const auto arrivals = box_arrivals(7, wall_factors(false));
    const auto whole = assembler().assemble(arrivals, 0.4).samples;
    const auto cut = assembler().assemble(arrivals, 0.1).samples;
    ASSERT_EQ(cut.size(), 4800U);
    // Arrivals past the end are left out, and with them what rings ahead of them.
    const std::size_t size = cut.size() - kDelayHalfLength;
    const auto error =
        support::response_error(std::span(cut).first(size), std::span(whole).first(size));
    EXPECT_LT(error.energy_db, -100.0);
}

TEST(ResponseAssembly, InAmbisonicsHasTheMonoResponseInItsFirstChannel) {
    const auto arrivals = box_arrivals(7, wall_factors(false));
    const auto channels = encode_ambisonic(assembler(), arrivals, 2);
    EXPECT_EQ(channels[0].samples, assembler().assemble(arrivals).samples);
}

/// Noise that dies away, from directions all around.
HrirSet some_head() {
    HrirSet head{.sample_rate = kRate, .directions = {}};
    for (std::size_t i = 0; i < 40; ++i) {
        const double z = -1.0 + (static_cast<double>(i) + 0.5) / 20.0;
        const double angle = 2.4 * static_cast<double>(i);
        const double radius = std::sqrt(1.0 - z * z);
        Hrir& hrir = head.directions.emplace_back();
        hrir.towards = {radius * std::cos(angle), radius * std::sin(angle), z};
        for (std::size_t n = 0; n < 96; ++n) {
            const double fade = std::exp(-static_cast<double>(n) / 12.0);
            hrir.left.push_back(fade * random_between(6, 2 * i, n, -1.0, 1.0));
            hrir.right.push_back(fade * random_between(6, 2 * i + 1, n, -1.0, 1.0));
        }
    }
    return head;
}

TEST(ResponseAssembly, AtTwoEarsIsTheSumOfArrivalsThroughTheirResponses) {
    const HrirInterpolator hrirs(some_head());
    for (const int order : {1, 4}) {
        auto arrivals = box_arrivals(order, wall_factors(true));
        arrivals[2].is_inverted = true;
        const auto ears = render_binaural(assembler(), arrivals, hrirs);
        for (std::size_t ear = 0; ear < 2; ++ear) {
            std::vector<double> expected(ears[ear].samples.size(), 0.0);
            for (const Arrival& arrival : arrivals) {
                const InterpolatedHrir hrir = hrirs.at(origin_seen_from({}, arrival));
                const std::vector<double> piece = reference().piece(arrival);
                const double sign = arrival.is_inverted ? -1.0 : 1.0;
                const auto begin = static_cast<std::ptrdiff_t>(std::floor(arrival.delay * kRate)) -
                                   63 + hrir.begin;
                for (std::size_t k = 0; k < hrir.ears[ear].size(); ++k) {
                    for (std::size_t n = 0; n < piece.size(); ++n) {
                        const std::ptrdiff_t at = begin + static_cast<std::ptrdiff_t>(n + k);
                        if (at >= 0 && at < static_cast<std::ptrdiff_t>(expected.size())) {
                            expected[static_cast<std::size_t>(at)] +=
                                sign * hrir.ears[ear][k] * piece[n];
                        }
                    }
                }
            }
            const auto error = support::response_error(ears[ear].samples, expected);
            EXPECT_LT(error.energy_db, -100.0) << order;
        }
    }
}

TEST(ResponseAssembly, InThirdOctavesIsTheSumOfItsArrivals) {
    const Bands& bands = Bands::third_octaves();
    const Assembler of_thirds(bands, kRate);
    const auto centres = bands.exact_hz();
    const support::ArrivalReference expected(
        {centres.begin(), centres.end()}, kRate, of_thirds.tables().filter.fft().size());
    // Absorption that changes little from band to band, as in rooms.
    std::vector<Arrival> arrivals(150);
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        arrivals[i].delay = random_between(5, 0, i, 0.002, 0.1);
        const double steepness = random(5, 1, i);
        const double bend = random(5, 2, i);
        for (std::size_t band = 0; band < bands.count(); ++band) {
            const double x = static_cast<double>(band) / 30.0;
            arrivals[i].pressure[band] = std::exp(-3.0 * steepness * x - bend * x * x);
        }
    }
    const auto found = of_thirds.assemble(arrivals);
    const std::vector<double> gains(arrivals.size(), 1.0);
    const auto error =
        support::response_error(found.samples, expected.sum(arrivals, gains, found.samples.size()));
    EXPECT_LT(error.energy_db, -100.0);
}

TEST(AddConvolution, HasTheBitsOfTheLoopOnEveryInstructionSet) {
    for (const std::size_t count : {1U, 7U, 40U, 200U}) {
        for (const std::size_t tap_count : {1U, 31U, 128U}) {
            std::vector<double> samples(count), taps(tap_count + 2 * kConvolutionMargin, 0.0);
            std::vector<double> expected(count + tap_count - 1);
            for (std::size_t n = 0; n < count; ++n) {
                samples[n] = random_between(7, 0, n, -1.0, 1.0);
            }
            for (std::size_t n = 0; n < tap_count; ++n) {
                taps[kConvolutionMargin + n] = random_between(7, 1, n, -1.0, 1.0);
            }
            for (std::size_t n = 0; n < expected.size(); ++n) {
                expected[n] = random_between(7, 2, n, -1.0, 1.0);
            }
            const std::vector<double> before = expected;
            for (std::size_t n = 0; n < count; ++n) {
                for (std::size_t tap = 0; tap < tap_count; ++tap) {
                    expected[n + tap] += 0.3 * samples[n] * taps[kConvolutionMargin + tap];
                }
            }
            for (const std::string& target : simd_targets()) {
                override_simd_target(target);
                std::vector<double> found = before;
                add_convolution(
                    0.3, samples.data(), count, &taps[kConvolutionMargin], tap_count, found.data());
                EXPECT_EQ(found, expected) << target << " " << count << " " << tap_count;
            }
            override_simd_target("auto");
        }
    }
}

// Every filter against the sum that stands for it, at all bins and not only at the nodes.
TEST(Representatives, MakeEveryFilterOfFewOthers) {
    const auto arrivals = box_arrivals(9, wall_factors(false));
    const ArrivalFilter filter(Bands::octaves(), kRate);
    const std::size_t bands = filter.bands_in_use();
    LargeArray<double> logs(padded(arrivals.size()) * (bands + 1), 0.0);
    std::vector<std::vector<std::complex<double>>> spectra;
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        const auto& pressure = arrivals[i].pressure;
        const double largest = *std::max_element(pressure.begin(), pressure.end());
        Spectrum relative{};
        for (std::size_t band = 0; band < bands; ++band) {
            relative[band] = pressure[band] / largest;
            logs[(i / kLanes * (bands + 1) + band) * kLanes + i % kLanes] =
                std::log(relative[band]);
        }
        filter.response(relative, spectra.emplace_back(filter.fft().bins()));
    }
    const FilterNodes nodes(filter);
    Representatives representatives;
    EXPECT_FALSE(representatives.find(nodes.rows(), logs, arrivals.size(), 10));
    ASSERT_TRUE(representatives.find(nodes.rows(), logs, arrivals.size(), 100));
    const auto pivots = representatives.pivots();
    EXPECT_LT(pivots.size(), 60U);
    EXPECT_TRUE(representatives.outside().empty());
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        double error = 0.0, energy = 0.0;
        for (std::size_t k = 0; k < spectra[i].size(); ++k) {
            std::complex<double> sum = 0.0;
            for (std::size_t m = 0; m < pivots.size(); ++m) {
                sum += representatives.weights(i)[m] * spectra[pivots[m]][k];
            }
            error += std::norm(sum - spectra[i][k]);
            energy += std::norm(spectra[i][k]);
        }
        EXPECT_LT(10.0 * std::log10(error / energy), -98.0) << i;
    }
    for (std::size_t m = 0; m < pivots.size(); ++m) {
        const auto weights = representatives.weights(pivots[m]);
        for (std::size_t j = 0; j < pivots.size(); ++j) {
            EXPECT_NEAR(weights[j], j == m ? 1.0 : 0.0, 1e-9);
        }
    }
}

}  // namespace
}  // namespace earshot::audio
