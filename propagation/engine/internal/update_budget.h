// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/engine/engine_options.h"

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace earshot::propagation {

/// What an update has cost so far, against its budget.
class WorkMeter {
public:
    explicit WorkMeter(const UpdateBudget& budget) : budget_(budget) {
        if (budget.milliseconds > 0.0) {
            begin_ = Clock::now();
        }
    }

    void add(std::uint64_t work) noexcept { work_ += work; }
    std::uint64_t work() const noexcept { return work_; }

    bool is_spent() const { return !(left(1) > 0); }
    /// Of `work` more units, what fits; at the rate so far where the budget is one of time.
    std::uint64_t left(std::uint64_t work) const {
        std::uint64_t fits = work;
        if (budget_.work > 0) {
            fits = std::min(fits, budget_.work > work_ ? budget_.work - work_ : 0);
        }
        if (budget_.milliseconds > 0.0) {
            const double spent =
                std::chrono::duration<double, std::milli>(Clock::now() - begin_).count();
            const double rest = budget_.milliseconds - spent;
            if (!(rest > 0.0)) {
                return 0;
            }
            // Units take as long as those before.
            const double rate = static_cast<double>(work_ + 1) / std::max(spent, 1e-3);
            const double units = rest * rate;
            if (units < static_cast<double>(fits)) {
                fits = static_cast<std::uint64_t>(units) + 1;
            }
        }
        return fits;
    }

private:
    using Clock = std::chrono::steady_clock;
    UpdateBudget budget_;
    Clock::time_point begin_{};
    std::uint64_t work_ = 0;
};

}  // namespace earshot::propagation
