// SPDX-License-Identifier: MIT
//
// bench_calibration [SEEDS [RAYS [NOISE_RAYS [THREADS [SCATTERING]]]]]: absorption of eight
// materials fitted to seven metrics of ten pairs in four octaves, measured with errors as large as
// the standard errors of NOISE_RAYS rays, by simulations of RAYS rays: how many of the 95 %
// intervals hold the truth, and the processor time of a calibration. If SCATTERING is 1, absorption
// and scattering of three materials of a room that tells them, by four pairs.

#include "earshot/base/error.h"
#include "earshot/base/parallel.h"

#include "calibration_statistic.h"
#include "harness.h"
#include <cstdio>
#include <cstdlib>

namespace {

using namespace earshot::propagation;

void print(const char* coefficient, const Coverage& sum) {
    const auto percent = [](std::size_t part, std::size_t whole) {
        return 100.0 * static_cast<double>(part) / static_cast<double>(whole);
    };
    std::printf(
        "%s, identified  %zu of %zu hold the truth, %.1f %%; at most %.1f standard errors off\n",
        coefficient,
        sum.identified_held,
        sum.identified,
        percent(sum.identified_held, sum.identified),
        sum.max_deviation);
    std::printf("%s, all         %zu of %zu, %.1f %%\n",
                coefficient,
                sum.all_held,
                sum.all,
                percent(sum.all_held, sum.all));
}

int run(int argc, char** argv) {
    const auto argument = [&](int index, long otherwise) {
        return argc > index ? std::strtol(argv[index], nullptr, 10) : otherwise;
    };
    StatisticOptions options;
    options.seeds = static_cast<std::uint64_t>(argument(1, 20));
    options.rays = static_cast<std::size_t>(argument(2, 65536));
    options.noise_rays = static_cast<std::size_t>(argument(3, 2048));
    earshot::Executor executor(static_cast<int>(argument(4, 1)));
    options.fit_scattering = argument(5, 0) != 0;
    const CalibrationCampaign campaign(
        options, options.fit_scattering ? flutter_room() : calibration_room());
    CalibrationStatistic sum;
    double processor = 0.0;
    for (std::uint64_t i = 0; i < options.seeds; ++i) {
        processor += bench::times_of([&] {
                         campaign.add(campaign.calibrate(options.first_seed + i, executor), sum);
                     }).processor;
    }
    print("absorption", sum.absorption);
    if (options.fit_scattering) {
        print("scattering", sum.scattering);
    }
    std::printf("reduced chi squared %.2f; %.1f simulations, %.1f s of processor time each fit\n",
                sum.reduced_chi_squared,
                sum.simulations,
                processor / static_cast<double>(options.seeds));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const earshot::Error& error) {
        std::fprintf(stderr, "%s\n", error.line().c_str());
        return 1;
    }
}
