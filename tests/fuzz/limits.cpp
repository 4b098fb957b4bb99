// SPDX-License-Identifier: MIT
#include "fuzz/limits.h"

#include <ctime>
#include <fstream>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

// The sanitizer's library defines it, whatever this file is compiled with.
extern "C" __attribute__((weak)) void __asan_init();

namespace earshot::test {

bool has_address_sanitizer() {
    return __asan_init != nullptr;
}

void limit_memory() {
    std::size_t pages = 0;  // of address space
    std::ifstream("/proc/self/statm") >> pages;
    if (has_address_sanitizer() || pages == 0) {
        return;
    }
    rlimit limit{};
    ::getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + kMaxInputBytes;
    ::setrlimit(RLIMIT_AS, &limit);
}

void restart_time_limit() {
    itimerval timer{};
    timer.it_value.tv_sec = kMaxInputSeconds;
    ::setitimer(ITIMER_PROF, &timer, nullptr);
}

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace earshot::test
