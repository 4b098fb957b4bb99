// SPDX-License-Identifier: MIT
#include "earshot/cli/progress_bar.h"

#include <algorithm>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

namespace earshot::cli {
namespace {

constexpr const char* kEraseLine = "\r\x1b[K";

std::size_t terminal_width(int file_descriptor) {
    constexpr std::size_t kUsualWidth = 80;
    winsize size{};
    const bool is_known = ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return is_known ? size.ws_col : kUsualWidth;
}

// "tracing [=======>      ]  45 %", short of the width so that the terminal does not wrap it.
std::string bar_line(std::string_view stage, double fraction, std::size_t width) {
    const std::string percent = std::to_string(static_cast<int>(fraction * 100.0)) + " %";
    const std::string label(stage.substr(0, width / 2));
    constexpr std::size_t kBrackets = 5;  // " [", "] " and the last column
    const std::size_t taken = label.size() + percent.size() + kBrackets;
    if (width <= taken) {
        return percent.substr(0, width);
    }
    const std::size_t room = width - taken;
    const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(room));
    return label + " [" + std::string(filled, '=') + std::string(room - filled, ' ') + "] " +
           percent;
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

ProgressBar::ProgressBar(bool quiet, int file_descriptor, std::chrono::milliseconds interval)
    : file_descriptor_(file_descriptor),
      interval_(interval),
      is_drawing_(!quiet && isatty(file_descriptor) == 1),
      last_drawn_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
    if (is_on_screen_) {
        write_all(file_descriptor_, kEraseLine);
    }
}

void ProgressBar::report(std::string_view stage, std::size_t done, std::size_t total) {
    const auto now = std::chrono::steady_clock::now();
    if (!is_drawing_ || now - last_drawn_ < interval_) {
        return;
    }
    last_drawn_ = now;
    is_on_screen_ = true;
    const double fraction =
        total == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
    write_all(file_descriptor_,
              kEraseLine + bar_line(stage, fraction, terminal_width(file_descriptor_)));
}

}  // namespace earshot::cli
