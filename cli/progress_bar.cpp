// SPDX-License-Identifier: MIT
#include "earshot/cli/progress_bar.h"

#include "earshot/cli/formatted.h"

#include <algorithm>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

namespace earshot::cli {
namespace {

constexpr const char* kEraseLine = "\r\x1b[K";

std::size_t terminal_width(int file_descriptor) {
    constexpr std::size_t kUsualWidth = 80;
    winsize size{};
    const bool is_known = ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return is_known ? size.ws_col : kUsualWidth;
}

// "tracing [=======>      ] 45 %, 120/s, 35 s left", short of the width so that the terminal does
// not wrap it; where the width does not hold everything, the rate and the time left go first.
std::string bar_line(std::string_view stage,
                     const std::string& percent,
                     const std::string& rate,
                     double fraction,
                     std::size_t width) {
    constexpr std::size_t kBrackets = 5;      // " [", "] " and the last column
    constexpr std::size_t kMinBarWidth = 10;  // a rate is not worth more of the bar
    const std::string label(stage.substr(0, width / 2));
    const bool rate_fits =
        label.size() + percent.size() + rate.size() + kBrackets + kMinBarWidth <= width;
    const std::string figures = percent + (rate_fits ? rate : "");
    const std::size_t taken = label.size() + figures.size() + kBrackets;
    if (width <= taken) {
        return percent.substr(0, width);
    }
    const std::size_t bar_width = width - taken;
    const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(bar_width));
    return label + " [" + std::string(filled, '=') + std::string(bar_width - filled, ' ') + "] " +
           figures;
}

/// "0.25/s", "120/s", "35.0k/s", "1.2M/s".
std::string rate_text(double per_second) {
    constexpr double kKilo = 1e3, kMega = 1e6;
    if (per_second >= kMega) {
        return formatted("%.1fM/s", per_second / kMega);
    }
    if (per_second >= kKilo) {
        return formatted("%.1fk/s", per_second / kKilo);
    }
    return formatted(per_second >= 10.0 ? "%.0f/s" : "%.2g/s", per_second);
}

/// "35 s left", "3 min left", "2.5 h left".
std::string time_left_text(double seconds) {
    constexpr double kMinute = 60.0, kHour = 3600.0;
    if (seconds < 2.0 * kMinute) {
        return formatted("%.0f s left", seconds);
    }
    if (seconds < 2.0 * kHour) {
        return formatted("%.0f min left", seconds / kMinute);
    }
    return formatted("%.1f h left", seconds / kHour);
}

void write_all(int file_descriptor, std::string_view text) {
    // A terminal that cannot be written is no reason to stop the work.
    while (!text.empty()) {
        const ssize_t written = write(file_descriptor, text.data(), text.size());
        if (written <= 0) {
            return;
        }
        text.remove_prefix(static_cast<std::size_t>(written));
    }
}

}  // namespace

ProgressBar::ProgressBar(ProgressBarOptions options)
    : options_(std::move(options)),
      is_terminal_(isatty(options_.file_descriptor) == 1),
      last_drawn_(options_.clock()),
      stage_begin_(last_drawn_) {}

ProgressBar::ProgressBar(bool quiet, int file_descriptor, std::chrono::milliseconds draw_interval)
    : ProgressBar(ProgressBarOptions{
          .quiet = quiet, .file_descriptor = file_descriptor, .draw_interval = draw_interval}) {}

ProgressBar::~ProgressBar() {
    if (is_on_screen_) {
        write_all(options_.file_descriptor, kEraseLine);
    }
}

std::string ProgressBar::rate_and_time_left(Time now, std::size_t done, std::size_t total) const {
    const double seconds = std::chrono::duration<double>(now - stage_begin_).count();
    if (done <= done_at_begin_ || done >= total || !(seconds > 0.0)) {
        return {};
    }
    const double per_second = static_cast<double>(done - done_at_begin_) / seconds;
    return ", " + rate_text(per_second) + ", " +
           time_left_text(static_cast<double>(total - done) / per_second);
}

void ProgressBar::report(std::string_view stage, std::size_t done, std::size_t total) {
    if (options_.quiet) {
        return;
    }
    const Time now = options_.clock();
    if (stage != stage_ || done < done_at_begin_) {
        stage_ = stage;
        stage_begin_ = now;
        done_at_begin_ = done;
    }
    if (now - last_drawn_ < (is_terminal_ ? options_.draw_interval : options_.line_interval)) {
        return;
    }
    last_drawn_ = now;
    const double fraction =
        total == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
    const std::string percent = std::to_string(static_cast<int>(fraction * 100.0)) + " %";
    const std::string rate = rate_and_time_left(now, done, total);
    if (is_terminal_) {
        is_on_screen_ = true;
        const std::size_t width = terminal_width(options_.file_descriptor);
        write_all(options_.file_descriptor,
                  kEraseLine + bar_line(stage, percent, rate, fraction, width));
    } else {
        write_all(options_.file_descriptor, stage_ + " " + percent + rate + "\n");
    }
}

}  // namespace earshot::cli
