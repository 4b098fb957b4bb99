// SPDX-License-Identifier: MIT
//
// bench_response_assembly [ORDER [REPEATS [REFERENCE [SIMD]]]]: microseconds per arrival of
// responses of a shoe-box of 8 x 6 x 3.5 m at 48 kHz, medians of the processor's time on one
// thread, in ten octaves, with walls of one material, of six, and with independent pressures in all
// bands; and how far they are from the sum of separately filtered arrivals
// (tests/support/arrival_reference.h), which REFERENCE 0 leaves out. SIMD: a name of base/simd.h.

#include "earshot/audio/impulse_response.h"
#include "earshot/audio/spatial.h"
#include "earshot/base/digest.h"
#include "earshot/base/random.h"
#include "earshot/base/simd.h"

#include "harness.h"
#include "support/arrival_reference.h"
#include "support/box_arrivals.h"
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using namespace earshot;
using audio::Arrival;

constexpr double kSampleRate = 48000.0;
constexpr std::size_t kFilterSize = 4096;

std::vector<Arrival> independent(std::vector<Arrival> arrivals) {
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        for (std::size_t band = 0; band < 10; ++band) {
            arrivals[i].pressure[band] = random_between(1, band, i, 0.125, 1.0);
        }
    }
    return arrivals;
}

void measure(const char* name, const std::vector<Arrival>& arrivals, int repeats, bool compare) {
    const audio::Bands& bands = audio::Bands::octaves();
    const audio::Assembler assembler(bands, kSampleRate);
    const double count = static_cast<double>(arrivals.size());
    audio::ImpulseResponse mono;
    const double seconds =
        bench::median_processor_time(repeats, [&] { mono = assembler.assemble(arrivals); });
    std::vector<audio::ImpulseResponse> channels;
    const double of_channels = bench::median_processor_time(
        repeats, [&] { channels = audio::encode_ambisonic(assembler, arrivals, 1); });
    Digest digest;
    for (const double sample : mono.samples) {
        digest.add(sample);
    }
    std::printf("%-20s %7zu arrivals: %7.2f us each, 4 channels %7.2f, digest %016llx\n",
                name,
                arrivals.size(),
                1e6 * seconds / count,
                1e6 * of_channels / count,
                static_cast<unsigned long long>(digest.value()));
    if (!compare) {
        return;
    }
    const auto centres = bands.exact_hz();
    const support::ArrivalReference reference(
        {centres.begin(), centres.end()}, kSampleRate, kFilterSize);
    const std::vector<double> gains(arrivals.size(), 1.0);
    std::vector<double> expected;
    const double by_reference = bench::times_of([&] {
                                    expected = reference.sum(arrivals, gains, mono.samples.size());
                                }).processor;
    const support::ResponseError error = support::response_error(mono.samples, expected);
    std::printf("%-20s %7.0f us each one by one; difference: energy %.1f dB, peak %.1f dB\n",
                "",
                1e6 * by_reference / count,
                error.energy_db,
                error.peak_db);
}

int run(int argc, char** argv) {
    const int order = argc > 1 ? std::atoi(argv[1]) : 14;
    const int repeats = argc > 2 ? std::atoi(argv[2]) : 9;
    const bool compare = argc <= 3 || std::atoi(argv[3]) != 0;
    override_simd_target(argc > 4 ? argv[4] : "auto");
    const auto alike = support::box_arrivals(order, support::wall_factors(true));
    measure("one material", alike, repeats, compare);
    measure("six materials",
            support::box_arrivals(order, support::wall_factors(false)),
            repeats,
            compare);
    measure("independent bands", independent(alike), repeats, compare);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_response_assembly", argc, argv, run);
}
