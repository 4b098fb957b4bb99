// SPDX-License-Identifier: MIT
//
// Takes the place of Executor::for_each in bench_scaling, which the linker is told to wrap.

#include "loop_counts.h"

#include "earshot/base/parallel.h"

#include <algorithm>
#include <ctime>
#include <functional>

namespace {

using Body = std::function<void(std::size_t, std::size_t)>;

bench::LoopCounts* counts = nullptr;  // null: nothing is counted
bool is_inside = false;

double seconds_of_thread() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void count_loop(std::size_t count, std::size_t grain, const Body& body) {
    double all = 0.0, longest = 0.0;
    is_inside = true;
    for (std::size_t begin = 0; begin < count; begin += grain) {
        const double start = seconds_of_thread();
        body(begin, std::min(count, begin + grain));
        const double seconds = seconds_of_thread() - start;
        all += seconds;
        longest = std::max(longest, seconds);
    }
    is_inside = false;
    ++counts->loops;
    counts->max_chunks = std::max(counts->max_chunks, earshot::chunk_count(count, grain));
    counts->in_loops += all;
    counts->bound_64 += std::max(longest, all / 64.0);
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
    if (counts == nullptr) {
        __real__ZN7earshot8Executor8for_eachEmmRKSt8functionIFvmmEE(executor, count, grain, body);
    } else if (is_inside) {
        earshot::Executor one(1);
        __real__ZN7earshot8Executor8for_eachEmmRKSt8functionIFvmmEE(&one, count, grain, body);
    } else {
        count_loop(count, grain, body);
    }
}

namespace bench {

LoopCounts count_loops(const std::function<void()>& work) {
    LoopCounts result;
    counts = &result;
    const double start = seconds_of_thread();
    work();
    result.all = seconds_of_thread() - start;
    counts = nullptr;
    return result;
}

}  // namespace bench
