// SPDX-License-Identifier: MIT
#include "earshot/io/internal/child_process.h"

#include "earshot/io/internal/descriptor.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <new>
#include <poll.h>
#include <string_view>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

namespace earshot::io {

namespace {

using Clock = std::chrono::steady_clock;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif
#else
constexpr bool kIsSanitized = false;
#endif

// Exit statuses of the child.
constexpr int kFinished = 0;
constexpr int kFailed = 1;
constexpr int kNoMemory = 2;

// How often the end of a child is looked for while its pipe is silent: another process may have
// inherited the pipe's other end and hold it open.
constexpr std::chrono::milliseconds kPollInterval{100};

// Bytes of address space that this process has; 0 if the system does not tell.
std::size_t address_space() {
    std::size_t pages = 0;
#ifdef __linux__
    const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0) {
        return 0;
    }
    std::array<char, 128> text{};
    const ssize_t size = ::read(file, text.data(), text.size());
    ::close(file);
    for (ssize_t i = 0; i < size && text[static_cast<std::size_t>(i)] >= '0'; ++i) {
        pages = 10 * pages + static_cast<std::size_t>(text[static_cast<std::size_t>(i)] - '0');
    }
#endif
    return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

// A limit may be lowered, never raised.
void lower_limit(int resource, std::size_t value) {
    rlimit limit{};
    if (::getrlimit(static_cast<decltype(RLIMIT_CPU)>(resource), &limit) == 0) {
        limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, value);
        ::setrlimit(static_cast<decltype(RLIMIT_CPU)>(resource), &limit);
    }
}

// What this process does with signals is none of the child's business.
void restore_signals() {
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGPIPE, SIGINT}) {
        if (!kIsSanitized || signal == SIGXCPU || signal == SIGPIPE) {
            ::signal(signal, SIG_DFL);
        }
    }
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void be_child(int pipe,
                           const ChildLimits& limits,
                           const std::function<void(const ByteSink&)>& work) {
#ifdef __linux__
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    restore_signals();
    lower_limit(RLIMIT_CORE, 0);
    lower_limit(RLIMIT_CPU, static_cast<std::size_t>(std::ceil(limits.processor_time)));
    if (const std::size_t present = address_space(); !kIsSanitized && present > 0) {
        lower_limit(RLIMIT_AS, present + limits.memory);
    }
    if (!kIsSanitized) {
        const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
        ::dup2(nowhere, STDERR_FILENO);
    }
    int status = kFinished;
    try {
        work([&](std::string_view bytes) {
            if (!write_all(pipe, bytes)) {
                ::_exit(kFailed);
            }
        });
    } catch (const std::bad_alloc&) {
        status = kNoMemory;
    } catch (...) {
        status = kFailed;
    }
    // Neither buffers nor objects of the parent are the child's to flush or destroy.
    ::_exit(status);
}

bool has_ended(pid_t child) {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           info.si_pid == child;
}

// Reads until the child has ended or closed the pipe; what else ends it is returned.
ChildEnd collect(
    int pipe, pid_t child, std::size_t max_size, Clock::time_point deadline, std::string& output) {
    std::array<char, 1U << 16U> buffer{};
    bool is_over = false;
    while (true) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
        if (left.count() <= 0) {
            return ChildEnd::time;
        }
        pollfd readable{pipe, POLLIN, 0};
        const auto wait = is_over ? std::chrono::milliseconds(0) : std::min(left, kPollInterval);
        const int ready = ::poll(&readable, 1, static_cast<int>(wait.count()));
        if (ready == 0 && is_over) {
            return ChildEnd::finished;
        }
        if (ready == 0) {
            is_over = has_ended(child);
        }
        if (ready <= 0) {
            continue;
        }
        const ssize_t count = ::read(pipe, buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count <= 0) {
            return ChildEnd::finished;
        }
        if (output.size() + static_cast<std::size_t>(count) > max_size) {
            return ChildEnd::output;
        }
        output.append(buffer.data(), static_cast<std::size_t>(count));
    }
}

// A child whose pipe is closed is about to end.
ChildEnd await_end(pid_t child, Clock::time_point deadline) {
    while (!has_ended(child)) {
        if (Clock::now() > deadline) {
            return ChildEnd::time;
        }
        ::poll(nullptr, 0, 1);
    }
    return ChildEnd::finished;
}

ChildEnd end_of(int status) {
    if (WIFEXITED(status)) {
        const int code = WEXITSTATUS(status);
        return code == kFinished   ? ChildEnd::finished
               : code == kNoMemory ? ChildEnd::memory
                                   : ChildEnd::failed;
    }
    switch (WTERMSIG(status)) {
        case SIGXCPU:
            return ChildEnd::time;
        case SIGKILL:  // what the system sends where memory is short
            return ChildEnd::memory;
        default:
            return ChildEnd::crashed;
    }
}

}  // namespace

ChildResult run_in_child(const ChildLimits& limits,
                         const std::function<void(const ByteSink&)>& work) {
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) != 0) {
        return {};
    }
    for (const int end : pipe) {
        ::fcntl(end, F_SETFD, FD_CLOEXEC);
    }
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(pipe[0]);
        be_child(pipe[1], limits, work);
    }
    ::close(pipe[1]);
    if (child < 0) {
        ::close(pipe[0]);
        return {};
    }
    const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                             std::chrono::duration<double>(limits.time));
    ChildResult result;
    try {
        result.end = collect(pipe[0], child, limits.output, deadline, result.output);
        if (result.end == ChildEnd::finished) {
            result.end = await_end(child, deadline);
        }
    } catch (...) {  // no memory for the output
        result.end = ChildEnd::memory;
    }
    ::close(pipe[0]);
    if (result.end != ChildEnd::finished) {
        ::kill(child, SIGKILL);
    }
    int status = 0;
    pid_t ended = 0;
    do {
        ended = ::waitpid(child, &status, 0);
    } while (ended < 0 && errno == EINTR);
    if (result.end == ChildEnd::finished && ended == child) {
        result.end = end_of(status);
    }
    return result;
}

}  // namespace earshot::io
