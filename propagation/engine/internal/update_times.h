// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace earshot::propagation {

/// How long updates took, of which the last 1,024 are kept.
class UpdateTimes {
public:
    void add(double milliseconds) {
        if (count_ > 0) {
            max_ = std::max(max_, milliseconds);
        }
        if (last_.size() < kKept) {
            last_.push_back(milliseconds);
        } else {
            last_[count_ % kKept] = milliseconds;
        }
        ++count_;
    }

    double median() const {
        std::vector<double> sorted = last_;
        if (sorted.empty()) {
            return 0.0;
        }
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        return *middle;
    }
    double max_after_first() const noexcept { return max_; }

private:
    static constexpr std::size_t kKept = 1024;
    std::vector<double> last_;
    std::size_t count_ = 0;
    double max_ = 0.0;
};

}  // namespace earshot::propagation
