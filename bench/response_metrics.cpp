// SPDX-License-Identifier: MIT
// Milliseconds of late noise and metrics of one pair, with filters that are kept, with none kept,
// and by the textbook (tests/audio/plain_metrics.h).
#include "earshot/audio/response_metrics.h"

#include "earshot/audio/energy_metrics.h"
#include "earshot/audio/late_noise.h"

#include "audio/plain_metrics.h"
#include "fourier_contenders.h"
#include "harness.h"
#include <cstdlib>
#include <functional>
#include <string>

namespace {

using namespace earshot;
using audio::Bands;

constexpr double kSampleRate = 48000.0;

struct Pair {
    std::vector<audio::Arrival> arrivals;
    audio::EnergyHistogram late{.reflection_growth = 3e6, .full_decay = true};
    audio::HistogramReplicates replicates;
};

/// 25 arrivals, and late sound that decays by 60 dB in 0.85 of the time, as a room of 170 cubic
/// metres has it; 48 replicates.
Pair some_pair(double time) {
    constexpr std::size_t kReplicates = 48;
    constexpr std::size_t kInterval = 4;
    Pair pair;
    for (std::uint64_t i = 0; i < 25; ++i) {
        audio::Arrival& arrival = pair.arrivals.emplace_back();
        arrival.delay = 0.01 + 0.0021 * static_cast<double>(i);
        for (std::size_t band = 0; band < Bands::octaves().count(); ++band) {
            arrival.pressure[band] =
                random_between(5, band, i, 0.3, 1.0) / (3.0 + static_cast<double>(i));
        }
    }
    pair.late.energy.resize(static_cast<std::size_t>(std::lround(1000.0 * time)));
    for (std::size_t bin = 0; bin < pair.late.energy.size() + kInterval; bin += kInterval) {
        pair.replicates.first_bin.push_back(std::min(bin, pair.late.energy.size()));
    }
    for (std::size_t r = 0; r < kReplicates; ++r) {
        auto& energy = pair.replicates.energy.emplace_back(pair.replicates.first_bin.size() - 1);
        for (std::size_t n = 15; n < pair.late.energy.size(); ++n) {
            const double decay =
                1e-3 * std::pow(10.0, -0.006 * static_cast<double>(n) / (0.85 * time));
            for (std::size_t band = 0; band < Bands::octaves().count(); ++band) {
                const double share = decay * (0.95 + 0.1 * random(r, band, n / kInterval));
                energy[n / kInterval][band] += share;
                pair.late.energy[n][band] += share / static_cast<double>(kReplicates);
            }
        }
    }
    return pair;
}

double milliseconds(int repeats, const std::function<void()>& work) {
    return 1e3 * bench::min_times_of(repeats, work).processor;
}

void print_row(const char* part, double kept, double anew, double plain) {
    std::printf("%-34s %8.2f %8.2f %9.1f\n", part, kept, anew, plain);
}

/// Response metrics by the textbook, which wants the squares of every octave twice where it is one
/// of speech.
void plain_response_metrics(const std::vector<double>& response) {
    std::array<std::vector<double>, 7> speech;
    for (std::size_t octave = 0; octave < audio::plain::kOctaves; ++octave) {
        const auto squared = audio::plain::squared(response, kSampleRate, octave);
        audio::plain::metrics_of(squared, audio::plain::lead(kSampleRate) + 480, kSampleRate);
        if (octave >= 2 && octave < 9) {
            speech[octave - 2] = squared;
        }
    }
    audio::plain::speech_index(speech, kSampleRate);
}

void compare_parts(double time, int repeats) {
    const Bands& bands = Bands::octaves();
    const Pair pair = some_pair(time);
    const audio::FilterCache cache;
    audio::ImpulseResponse response = audio::assemble(bands, pair.arrivals);
    const auto noise = audio::late_noise(bands, pair.late, kSampleRate, 1, cache);
    response.samples.resize(noise.size(), 0.0);
    for (std::size_t n = 0; n < noise.size(); ++n) {
        response.samples[n] += noise[n];
    }
    std::printf("%-34s %8s %8s %9s\n", "ms, ten octaves, 48 kHz", "kept", "anew", "textbook");
    const double noise_kept =
        milliseconds(repeats, [&] { audio::late_noise(bands, pair.late, kSampleRate, 1, cache); });
    print_row("late noise",
              noise_kept,
              milliseconds(repeats, [&] { audio::late_noise(bands, pair.late, kSampleRate, 1); }),
              milliseconds(1, [&] { audio::plain::late_noise(pair.late, kSampleRate, 1); }));
    const audio::MetricsOptions options{.full_decay = true};
    const double response_kept =
        milliseconds(repeats, [&] { audio::response_metrics(bands, response, options, cache); });
    print_row("metrics of the response",
              response_kept,
              milliseconds(repeats, [&] { audio::response_metrics(bands, response, options); }),
              milliseconds(1, [&] { plain_response_metrics(response.samples); }));
    const double expected =
        milliseconds(repeats, [&] { audio::energy_metrics(bands, pair.arrivals, pair.late); });
    const double with_errors = milliseconds(repeats, [&] {
        audio::energy_metrics(
            bands, pair.arrivals, pair.late, {.replicates = &pair.replicates, .speech = {}});
    });
    std::printf("%-34s %8.2f\n", "expected metrics", expected);
    std::printf("%-34s %8.2f\n", "their standard errors", with_errors - expected);
    std::printf("%-34s %8.2f, %.2f without standard errors\n",
                "all of a pair",
                noise_kept + response_kept + with_errors,
                noise_kept + response_kept + expected);
}

int run(int argc, char** argv) {
    const double time = argc > 1 ? std::atof(argv[1]) : 1.0;
    const int repeats = argc > 2 ? std::atoi(argv[2]) : 15;
    if (!(time >= 0.2 && time <= 20.0) || repeats < 1) {
        throw Error("arguments", "SECONDS 0.2 ... 20, REPEATS at least 1", "see bench/README.md");
    }
    compare_parts(time, repeats);
    bench::compare_fourier_transforms(repeats);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_response_metrics", argc, argv, run);
}
