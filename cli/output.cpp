// SPDX-License-Identifier: MIT
#include "earshot/cli/output.h"

#include "earshot/io/escape.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace earshot::cli {
namespace {

// Colour is for people: not in a file, and not where NO_COLOR asks for none.
bool shows_colour() {
    const char* const refused = std::getenv("NO_COLOR");
    const char* const terminal = std::getenv("TERM");
    return (refused == nullptr || *refused == '\0') && terminal != nullptr &&
           std::string_view(terminal) != "dumb" && isatty(STDERR_FILENO) == 1;
}

// "earshot: KIND: MESSAGE", KIND in bold and the given colour (ISO 6429) on a terminal.
void print_line(const std::string& kind, const char* colour, const std::string& message) {
    const std::string shown_kind =
        shows_colour() ? std::string("\x1b[1;") + colour + "m" + kind + ":\x1b[0m" : kind + ":";
    // One call, so that lines of several processes do not mix. There is nowhere to report a
    // failure.
    const std::string text = "earshot: " + shown_kind + " " + on_one_line(message) + "\n";
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

}  // namespace

void prepare_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) == -1 && errno == EBADF) {
            // The lowest free number is this one. Opened the wrong way round, so that using it
            // fails.
            static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
        }
    }
    std::signal(SIGPIPE, SIG_IGN);
}

void write_output(std::string_view output) {
    const std::string escaped = io::escape_controls(output, true);
    std::string_view text = escaped;
    while (!text.empty()) {
        const ssize_t written = write(STDOUT_FILENO, text.data(), text.size());
        if (written > 0) {
            text.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno == EPIPE) {
            return;
        } else if (errno != EINTR) {
            throw Error("standard output",
                        std::string("cannot be written: ") + std::strerror(errno),
                        "check where it is redirected");
        }
    }
}

void print_error(const std::string& message) {
    constexpr const char* kRed = "31";
    print_line("error", kRed, message);
}

void print_warnings(const Warnings& warnings) {
    constexpr const char* kYellow = "33";
    for (const Warning& warning : warnings) {
        print_line("warning", kYellow, warning.subject + ": " + warning.what);
    }
}

std::string on_one_line(std::string_view text) {
    return io::escape_controls(text);
}

}  // namespace earshot::cli
