// SPDX-License-Identifier: MIT
#include "earshot/base/parallel.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace earshot {

struct Executor::Arena {
    explicit Arena(int threads) : arena(threads) {
        // oneTBB starts as many workers as there are cores unless told otherwise, and complains on
        // standard error when an arena asks for more.
        if (threads > tbb::this_task_arena::max_concurrency()) {
            more_workers.emplace(tbb::global_control::max_allowed_parallelism,
                                 static_cast<std::size_t>(threads));
        }
    }
    std::optional<tbb::global_control> more_workers;
    tbb::task_arena arena;
};

Executor::Executor(int threads) : threads_(threads) {
    if (threads < 0) {
        throw Error("threads",
                    "cannot be negative (" + std::to_string(threads) + ")",
                    "use 0 for all cores");
    }
    if (threads_ == 0) {
        threads_ = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    }
    if (threads_ > 1) {
        arena_ = std::make_unique<Arena>(threads_);
    }
}

Executor::~Executor() = default;

void Executor::for_each(std::size_t count,
                        std::size_t grain,
                        const std::function<void(std::size_t, std::size_t)>& body) {
    EARSHOT_ASSERT(grain > 0);
    const std::size_t chunks = chunk_count(count, grain);
    const auto run_chunk = [&](std::size_t chunk) {
        body(chunk * grain, std::min(count, (chunk + 1) * grain));
    };
    if (!arena_ || chunks < 2) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
            run_chunk(chunk);
        }
        return;
    }
    // Every chunk runs even after one has thrown, so that the exception that leaves is always the
    // lowest chunk's, as on one thread.
    std::vector<std::exception_ptr> failures(chunks);
    arena_->arena.execute([&] {
        tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
            try {
                run_chunk(chunk);
            } catch (...) {
                failures[chunk] = std::current_exception();
            }
        });
    });
    for (const std::exception_ptr& failure : failures) {
        if (failure) {
            std::rethrow_exception(failure);
        }
    }
}

Executor& Executor::serial() {
    static Executor executor(1);
    return executor;
}

}  // namespace earshot
