// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/progress.h"

#include <chrono>

namespace earshot::cli {

/// Progress on one line of a terminal, erased at the end. Draws nothing where the file descriptor
/// is not a terminal.
class ProgressBar : public Progress {
public:
    /// Draws at most once per `interval`, and not before the first has passed, so that quick work
    /// shows nothing. `quiet` draws nothing in any case. File descriptor 2 is standard error.
    explicit ProgressBar(bool quiet,
                         int file_descriptor = 2,
                         std::chrono::milliseconds interval = std::chrono::milliseconds(100));
    ~ProgressBar() override;
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void report(std::string_view stage, std::size_t done, std::size_t total) override;

private:
    int file_descriptor_;
    std::chrono::milliseconds interval_;
    bool is_drawing_;
    bool is_on_screen_ = false;
    std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace earshot::cli
