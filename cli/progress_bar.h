// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/progress.h"

#include <chrono>
#include <functional>
#include <string>

namespace earshot::cli {

struct ProgressBarOptions {
    bool quiet = false;       ///< show nothing
    int file_descriptor = 2;  ///< standard error
    /// A terminal's line is drawn at most once per interval, and not before the first has passed,
    /// so that quick work shows nothing.
    std::chrono::milliseconds draw_interval{100};
    /// The same for the lines that are written where the file descriptor is not a terminal.
    std::chrono::milliseconds line_interval{10000};
    std::function<std::chrono::steady_clock::time_point()> clock{std::chrono::steady_clock::now};
};

/// Shows how far long work has come, at what rate it goes on and how much time is left: on one line
/// of a terminal, erased at the end, or else in a new line now and then. Rate and time left are
/// those of the current stage.
class ProgressBar : public Progress {
public:
    explicit ProgressBar(ProgressBarOptions options);
    /// `quiet` and the file descriptor as in ProgressBarOptions.
    explicit ProgressBar(bool quiet,
                         int file_descriptor = 2,
                         std::chrono::milliseconds draw_interval = std::chrono::milliseconds(100));
    ~ProgressBar() override;
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void report(std::string_view stage, std::size_t done, std::size_t total) override;

private:
    using Time = std::chrono::steady_clock::time_point;

    std::string rate_and_time_left(Time now, std::size_t done, std::size_t total) const;

    ProgressBarOptions options_;
    bool is_terminal_;
    bool is_on_screen_ = false;
    Time last_drawn_;

    // Of the first report of the current stage.
    std::string stage_;
    Time stage_begin_;
    std::size_t done_at_begin_ = 0;
};

}  // namespace earshot::cli
