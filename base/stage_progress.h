// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/progress.h"

#include <cstddef>
#include <mutex>
#include <string_view>

namespace earshot {

/// Counts the steps of one stage that are done on several threads, and reports each. Steps of which
/// nobody wants to know (`progress` is null) cost nothing.
class StageProgress {
public:
    /// `done` of `total` steps have been done before.
    StageProgress(Progress* progress,
                  std::string_view stage,
                  std::size_t total,
                  std::size_t done = 0)
        : progress_(progress), stage_(stage), total_(total), done_(done) {
        add(0);
    }

    /// `count` more steps are done. Callable from any thread.
    void add(std::size_t count) {
        if (progress_ != nullptr) {
            const std::lock_guard lock(mutex_);
            done_ += count;
            progress_->report(stage_, done_, total_);
        }
    }

    /// The stage is over, whether or not all of its steps were needed.
    void finish() {
        if (progress_ != nullptr) {
            const std::lock_guard lock(mutex_);
            if (done_ < total_) {
                done_ = total_;
                progress_->report(stage_, done_, total_);
            }
        }
    }

private:
    Progress* progress_;
    std::string_view stage_;
    std::size_t total_;
    std::size_t done_;
    std::mutex mutex_;
};

/// One of several parts of a stage, in the units of the part; parts of different sizes count alike.
class PartProgress : public Progress {
public:
    PartProgress(Progress* whole, std::size_t part, std::size_t parts)
        : whole_(whole), part_(part), parts_(parts) {}

    void report(std::string_view stage, std::size_t done, std::size_t total) override {
        if (whole_ != nullptr && total > 0) {
            whole_->report(stage, part_ * total + done, parts_ * total);
        }
    }

private:
    Progress* whole_;
    std::size_t part_, parts_;
};

}  // namespace earshot
