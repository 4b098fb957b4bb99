// SPDX-License-Identifier: MIT
//
// Takes the place of Executor::for_each in bench_scaling, which the linker is told to wrap.

#include "loop_counts.h"

#include "earshot/base/parallel.h"

#include <algorithm>
#include <ctime>
#include <functional>
#include <mutex>

namespace {

using Body = std::function<void(std::size_t, std::size_t)>;

bench::LoopCounts counts;
thread_local bool is_inside = false;

double seconds_of_thread() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

// Executor::for_each(std::size_t, std::size_t, const Body&), as compilers for Linux name it.
extern "C" {
void __real__ZN7earshot8Executor8for_eachEmmRKSt8functionIFvmmEE(  // NOLINT
    earshot::Executor* executor,
    std::size_t count,
    std::size_t grain,
    const Body& body);
void __wrap__ZN7earshot8Executor8for_eachEmmRKSt8functionIFvmmEE(  // NOLINT
    earshot::Executor* executor,
    std::size_t count,
    std::size_t grain,
    const Body& body);
}

void __wrap__ZN7earshot8Executor8for_eachEmmRKSt8functionIFvmmEE(  // NOLINT
    earshot::Executor* executor,
    std::size_t count,
    std::size_t grain,
    const Body& body) {
    if (is_inside) {
        __real__ZN7earshot8Executor8for_eachEmmRKSt8functionIFvmmEE(executor, count, grain, body);
        return;
    }
    std::mutex mutex;
    double all = 0.0, longest = 0.0;
    std::size_t chunks = 0;
    const Body timed = [&](std::size_t begin, std::size_t end) {
        is_inside = true;
        const double start = seconds_of_thread();
        body(begin, end);
        const double seconds = seconds_of_thread() - start;
        is_inside = false;
        const std::lock_guard lock(mutex);
        all += seconds;
        longest = std::max(longest, seconds);
        ++chunks;
    };
    __real__ZN7earshot8Executor8for_eachEmmRKSt8functionIFvmmEE(executor, count, grain, timed);
    ++counts.loops;
    counts.max_chunks = std::max(counts.max_chunks, chunks);
    counts.in_loops += all;
    counts.bound_64 += std::max(longest, all / 64.0);
}

namespace bench {

void reset_loop_counts() {
    counts = {};
}

LoopCounts loop_counts() {
    return counts;
}

}  // namespace bench
