// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/engine/engine_statistics.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

namespace earshot::propagation {

/// Counts blocks by the share of their duration that they took, by the processor's time stamp
/// counter, which takes no system call to read. Where there is none nothing is counted.
class LoadHistogram {
public:
    /// Compares the counter with the clock for a millisecond. `seconds`: of a block.
    explicit LoadHistogram(double seconds);

    /// The counter now; 0 where there is none.
    static std::uint64_t ticks() noexcept;
    /// Audio thread: a block took so long.
    void count(std::uint64_t ticks) noexcept;

    std::uint64_t blocks() const noexcept;
    std::array<std::uint64_t, EngineStatistics::kLoadSteps + 1> load() const noexcept;

private:
    std::uint64_t ticks_per_step_ = 0;
    std::array<std::atomic<std::uint64_t>, EngineStatistics::kLoadSteps + 1> counts_{};
};

}  // namespace earshot::propagation
