// SPDX-License-Identifier: MIT
#include "earshot/base/internal/arena.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

namespace earshot {

struct Arena::Threads {
    explicit Threads(int count) : arena(count) {}
    tbb::task_arena arena;
};

Arena::Arena(int threads) {
    // oneTBB's first arena limits all later ones, with a line on standard error; a limit set by
    // hand is only a ceiling. More threads than this help nobody and change no result.
    constexpr int kMaxThreads = 256;
    static const tbb::global_control ceiling(tbb::global_control::max_allowed_parallelism,
                                             kMaxThreads);
    threads_ = std::make_unique<Threads>(std::min(threads, kMaxThreads));
}

Arena::~Arena() = default;

void Arena::run(std::size_t count, void (*task)(void* context, std::size_t i), void* context) {
    threads_->arena.execute([=] {
        tbb::parallel_for(std::size_t{0}, count, [=](std::size_t i) { task(context, i); });
    });
}

}  // namespace earshot
