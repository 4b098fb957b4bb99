// SPDX-License-Identifier: MIT
#include "earshot/cli/progress_bar.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <fcntl.h>
#include <stdlib.h>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

namespace earshot::test {
namespace {

// A terminal that nobody looks at, 60 columns wide.
class Terminal {
public:
    Terminal() : screen_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
        if (grantpt(screen_) == 0 && unlockpt(screen_) == 0) {
            keyboard_ = open(ptsname(screen_), O_RDWR | O_NOCTTY);
        }
        const winsize size{24, 60, 0, 0};
        ioctl(keyboard_, TIOCSWINSZ, &size);
    }
    ~Terminal() {
        close(keyboard_);
        close(screen_);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    int descriptor() const { return keyboard_; }

    // What has been written since the last call.
    std::string shown() const {
        std::array<char, 4096> buffer{};
        const ssize_t count = read(screen_, buffer.data(), buffer.size());
        return {buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
    }

private:
    int screen_ = -1;
    int keyboard_ = -1;
};

constexpr std::chrono::milliseconds kAtOnce{0};
constexpr std::chrono::hours kNever{1};

TEST(ProgressBar, DrawsOneLineAndErasesItAtTheEnd) {
    const Terminal terminal;
    ASSERT_GE(terminal.descriptor(), 0);
    {
        cli::ProgressBar bar(false, terminal.descriptor(), kAtOnce);
        bar.report("tracing", 45, 100);
        const std::string line = terminal.shown();
        const std::string erase = "\r\x1b[K";
        ASSERT_TRUE(line.starts_with(erase)) << line;
        EXPECT_LT(line.size() - erase.size(), 60U);
        EXPECT_NE(line.find("tracing [====="), std::string::npos) << line;
        EXPECT_TRUE(line.ends_with("] 45 %")) << line;
    }
    EXPECT_EQ(terminal.shown(), "\r\x1b[K");
}

TEST(ProgressBar, ShowsNothingOfQuickWork) {
    const Terminal terminal;
    {
        cli::ProgressBar bar(false, terminal.descriptor(), kNever);
        bar.report("tracing", 100, 100);
    }
    EXPECT_EQ(terminal.shown(), "");
}

TEST(ProgressBar, ReplacesWhatItDrewBefore) {
    const Terminal terminal;
    cli::ProgressBar bar(false, terminal.descriptor(), kAtOnce);
    bar.report("tracing", 1, 100);
    EXPECT_TRUE(terminal.shown().ends_with(" 1 %"));
    bar.report("writing", 2, 2);
    const std::string line = terminal.shown();
    EXPECT_TRUE(line.starts_with("\r\x1b[Kwriting [=")) << line;
    EXPECT_TRUE(line.ends_with("=] 100 %")) << line;
}

TEST(ProgressBar, DrawsNothingWhereItIsQuietOrNotATerminal) {
    const Terminal terminal;
    cli::ProgressBar quiet(true, terminal.descriptor(), kAtOnce);
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe2(ends.data(), O_NONBLOCK), 0);
    {
        cli::ProgressBar piped(false, ends[1], kAtOnce);
        quiet.report("tracing", 1, 2);
        piped.report("tracing", 1, 2);
    }
    char byte = 0;
    EXPECT_EQ(read(ends[0], &byte, 1), -1);
    EXPECT_EQ(terminal.shown(), "");
    close(ends[0]);
    close(ends[1]);
}

/// A bar whose time passes only when a test says so.
class TimedBar {
public:
    explicit TimedBar(int file_descriptor)
        : bar_({.file_descriptor = file_descriptor, .clock = [this] { return now_; }}) {}

    void report_after(std::chrono::milliseconds time, std::size_t done, std::size_t total) {
        now_ += time;
        bar_.report("late rays", done, total);
    }

private:
    std::chrono::steady_clock::time_point now_{};
    cli::ProgressBar bar_;
};

using std::chrono::milliseconds;

TEST(ProgressBar, TellsRateAndTimeLeft) {
    const Terminal terminal;
    TimedBar bar(terminal.descriptor());
    bar.report_after(milliseconds(0), 0, 100000);
    bar.report_after(milliseconds(2000), 10000, 100000);  // 5000 a second, 90000 to go
    const std::string line = terminal.shown();
    EXPECT_TRUE(line.ends_with("] 10 %, 5.0k/s, 18 s left")) << line;
    EXPECT_LT(line.size(), 60U + 4U);
    bar.report_after(milliseconds(2000), 10100, 100000);
    EXPECT_TRUE(terminal.shown().ends_with("] 10 %, 2.5k/s, 36 s left"));
    bar.report_after(milliseconds(100), 100000, 100000);
    EXPECT_TRUE(terminal.shown().ends_with("=] 100 %"));
}

TEST(ProgressBar, TellsLongTimesInMinutesAndHours) {
    const Terminal terminal;
    TimedBar bar(terminal.descriptor());
    bar.report_after(milliseconds(0), 0, 1000);
    bar.report_after(milliseconds(10000), 20, 1000);
    EXPECT_TRUE(terminal.shown().ends_with("] 2 %, 2/s, 8 min left"));
    bar.report_after(milliseconds(70000), 25, 1000);
    EXPECT_TRUE(terminal.shown().ends_with("] 2 %, 0.31/s, 52 min left"));
    bar.report_after(milliseconds(920000), 50, 1000);
    EXPECT_TRUE(terminal.shown().ends_with("] 5 %, 0.05/s, 5.3 h left"));
}

TEST(ProgressBar, WritesALineEveryTenSecondsWhereThereIsNoTerminal) {
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe2(ends.data(), O_NONBLOCK), 0);
    {
        TimedBar bar(ends[1]);
        bar.report_after(milliseconds(0), 0, 100);
        for (std::size_t done = 1; done <= 25; ++done) {
            bar.report_after(milliseconds(1000), done, 100);
        }
    }
    std::array<char, 4096> buffer{};
    const ssize_t count = read(ends[0], buffer.data(), buffer.size());
    EXPECT_EQ(std::string(buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0),
              "late rays 10 %, 1/s, 90 s left\nlate rays 20 %, 1/s, 80 s left\n");
    close(ends[0]);
    close(ends[1]);
}

}  // namespace
}  // namespace earshot::test
