// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/load_histogram.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>

#if defined(__x86_64__) || defined(__i386__)
#include <x86intrin.h>
#endif

namespace earshot::propagation {

std::uint64_t LoadHistogram::ticks() noexcept {
#if defined(__x86_64__) || defined(__i386__)
    return __rdtsc();
#else
    return 0;
#endif
}

LoadHistogram::LoadHistogram(double seconds) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    const std::uint64_t first = ticks();
    Clock::time_point now = begin;
    while (now - begin < std::chrono::milliseconds(1)) {
        now = Clock::now();
    }
    const double elapsed = std::chrono::duration<double>(now - begin).count();
    const double per_second = static_cast<double>(ticks() - first) / elapsed;
    ticks_per_step_ = static_cast<std::uint64_t>(per_second * seconds /
                                                 static_cast<double>(EngineStatistics::kLoadSteps));
}

void LoadHistogram::count(std::uint64_t ticks) noexcept {
    if (ticks_per_step_ == 0) {
        return;
    }
    const std::uint64_t step =
        std::min<std::uint64_t>(ticks / ticks_per_step_, EngineStatistics::kLoadSteps);
    std::atomic<std::uint64_t>& count = counts_[static_cast<std::size_t>(step)];
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

std::uint64_t LoadHistogram::blocks() const noexcept {
    std::uint64_t sum = 0;
    for (const auto& count : counts_) {
        sum += count.load(std::memory_order_relaxed);
    }
    return sum;
}

std::array<std::uint64_t, EngineStatistics::kLoadSteps + 1> LoadHistogram::load() const noexcept {
    std::array<std::uint64_t, EngineStatistics::kLoadSteps + 1> result{};
    std::transform(counts_.begin(), counts_.end(), result.begin(), [](const auto& count) {
        return count.load(std::memory_order_relaxed);
    });
    return result;
}

double EngineStatistics::load_quantile(double share) const noexcept {
    std::uint64_t all = 0;
    for (const std::uint64_t count : load) {
        all += count;
    }
    const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(all)));
    std::uint64_t sum = 0;
    for (std::size_t step = 0; step <= kLoadSteps; ++step) {
        sum += load[step];
        if (sum >= wanted) {
            return static_cast<double>(step + 1) / static_cast<double>(kLoadSteps);
        }
    }
    return 1.0;
}

}  // namespace earshot::propagation
