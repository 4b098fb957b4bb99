// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <limits>
#include <utility>
#include <vector>

namespace bench {

/// How long something took, in seconds.
struct Times {
    double clock = 0.0;      ///< wall clock
    double processor = 0.0;  ///< of all threads together
};

template <typename Work>
Times times_of(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t used = std::clock();
    work();
    const std::clock_t used_after = std::clock();
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            static_cast<double>(used_after - used) / CLOCKS_PER_SEC};
}

/// Seconds on the wall clock.
template <typename Work>
double seconds_of(Work&& work) {
    return times_of(work).clock;
}

/// The minima over several runs.
template <typename Work>
Times min_times_of(int repeats, Work&& work) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Times best{kInfinity, kInfinity};
    for (int repeat = 0; repeat < repeats; ++repeat) {
        const Times times = times_of(work);
        best.clock = std::min(best.clock, times.clock);
        best.processor = std::min(best.processor, times.processor);
    }
    return best;
}

/// The upper of two middle values; 0 of none.
inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

/// The median over several runs, in seconds of all threads together, after one that warms up.
template <typename Work>
double median_processor_time(int repeats, Work&& work) {
    work();
    std::vector<double> times;
    for (int repeat = 0; repeat < repeats; ++repeat) {
        times.push_back(times_of(work).processor);
    }
    return median(std::move(times));
}

/// What main() does: `run` returns the exit status; an Error is printed as one line and is 1.
inline int run_main(const char* program, int argc, char** argv, int (*run)(int, char**)) {
    try {
        return run(argc, argv);
    } catch (const earshot::Error& error) {
        std::fprintf(stderr, "%s: %s\n", program, error.line().c_str());
        return 1;
    }
}

}  // namespace bench
