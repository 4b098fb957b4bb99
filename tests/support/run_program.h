// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <signal.h>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace earshot::test {

/// How a program is run. Standard input is empty.
struct RunOptions {
    std::vector<std::pair<std::string, std::string>> environment{};  ///< beside what is inherited
    std::filesystem::path standard_output{};  ///< a file instead of RunResult::out, "/dev/full"
    bool closes_standard_output = false;      ///< starts the program without one
    std::chrono::seconds max_time{1200};      ///< then it is taken to hang, and killed
};

struct RunResult {
    int status = -1;       ///< exit status; 128 + N where signal N ended the program
    std::string out;       ///< standard output
    std::string err;       ///< standard error
    bool is_late = false;  ///< killed because it took too long
};

namespace internal {

// In the child, between fork and exec.
[[noreturn]] inline void become(const std::vector<std::string>& command,
                                const RunOptions& options,
                                int out,
                                int err) {
    constexpr int kCannotRun = 127;
    const int in = open("/dev/null", O_RDONLY);
    dup2(in, STDIN_FILENO);
    if (!options.standard_output.empty()) {
        out = open(options.standard_output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    }
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    if (options.closes_standard_output) {
        close(STDOUT_FILENO);
    }
    for (const auto& [name, value] : options.environment) {
        setenv(name.c_str(), value.c_str(), 1);
    }
    std::vector<char*> arguments;
    for (const std::string& word : command) {
        arguments.push_back(const_cast<char*>(word.c_str()));
    }
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    _exit(kCannotRun);
}

// Reads both pipes to their ends; false if that takes longer than it may.
inline bool read_both(std::array<pollfd, 2> pipes,
                      std::array<std::string*, 2> texts,
                      std::chrono::steady_clock::time_point deadline) {
    std::array<char, 65536> buffer{};
    std::size_t open_pipes = pipes.size();
    while (open_pipes > 0) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
            deadline - std::chrono::steady_clock::now());
        if (left.count() <= 0 ||
            poll(pipes.data(), pipes.size(), static_cast<int>(left.count())) == 0) {
            return false;
        }
        for (std::size_t i = 0; i < pipes.size(); ++i) {
            if (pipes[i].revents == 0) {
                continue;
            }
            const ssize_t count = read(pipes[i].fd, buffer.data(), buffer.size());
            if (count > 0) {
                texts[i]->append(buffer.data(), static_cast<std::size_t>(count));
            } else if (count == 0) {
                pipes[i].fd = -1;  // poll skips it from here on
                --open_pipes;
            }
        }
    }
    return true;
}

}  // namespace internal

/// Runs a program and waits for its end. command[0] is its path. Throws if it cannot be started.
inline RunResult run_program(const std::vector<std::string>& command,
                             const RunOptions& options = {}) {
    std::array<int, 2> out{};
    std::array<int, 2> err{};
    if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) {
        throw std::runtime_error("cannot make a pipe");
    }
    const pid_t child = fork();
    if (child < 0) {
        throw std::runtime_error("cannot start a process");
    }
    if (child == 0) {
        internal::become(command, options, out[1], err[1]);
    }
    close(out[1]);
    close(err[1]);

    RunResult result;
    const auto deadline = std::chrono::steady_clock::now() + options.max_time;
    result.is_late = !internal::read_both({pollfd{out[0], POLLIN, 0}, pollfd{err[0], POLLIN, 0}},
                                          {&result.out, &result.err},
                                          deadline);
    if (result.is_late) {
        kill(child, SIGKILL);
    }
    close(out[0]);
    close(err[0]);
    int status = 0;
    waitpid(child, &status, 0);
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

}  // namespace earshot::test
