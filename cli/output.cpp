// SPDX-License-Identifier: MIT
#include "earshot/cli/output.h"

#include "earshot/io/escape.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace earshot::cli {
namespace {

void print_line(const std::string& line) {
    // One call, so that lines of several processes do not mix. There is nowhere to report a
    // failure.
    const std::string text = on_one_line(line) + "\n";
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
    print_line("earshot: error: " + message);
}

void print_warnings(const Warnings& warnings) {
    for (const Warning& warning : warnings) {
        print_line("earshot: warning: " + warning.subject + ": " + warning.what);
    }
}

std::string on_one_line(std::string_view text) {
    return io::escape_controls(text);
}

}  // namespace earshot::cli
