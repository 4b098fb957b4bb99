// SPDX-License-Identifier: MIT
#include "earshot/base/parallel.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/base/internal/arena.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#ifdef __SANITIZE_THREAD__
// Races inside oneTBB's library, where the sanitizer sees the accesses but not the locks.
extern "C" const char* __tsan_default_suppressions() {
    return "called_from_lib:libtbb.so";
}
#endif

namespace earshot {
namespace {

/// One call of for_each, shared by the threads that work on it.
struct Loop {
    // What came before happens before every chunk, and every chunk before what comes after. oneTBB
    // sees to that as well, but the thread sanitizer can only see these two.
    std::atomic<bool> has_started{false};
    std::atomic<std::size_t> finished{0};

    std::size_t count = 0;
    std::size_t grain = 1;
    const std::function<void(std::size_t, std::size_t)>* body = nullptr;
    std::vector<std::exception_ptr> failures{};  // per chunk
    std::atomic<std::size_t> first_failed{std::numeric_limits<std::size_t>::max()};

    void run_chunk(std::size_t chunk) const {
        (*body)(chunk * grain, std::min(count, (chunk + 1) * grain));
    }
};

void run_chunk_of(void* context, std::size_t chunk) {
    Loop& loop = *static_cast<Loop*>(context);
    static_cast<void>(loop.has_started.load(std::memory_order_acquire));
    // What follows a chunk that has thrown is left out, as on one thread.
    if (chunk < loop.first_failed.load(std::memory_order_relaxed)) {
        try {
            loop.run_chunk(chunk);
        } catch (...) {
            loop.failures[chunk] = std::current_exception();
            std::size_t first = loop.first_failed.load(std::memory_order_relaxed);
            while (chunk < first && !loop.first_failed.compare_exchange_weak(
                                        first, chunk, std::memory_order_relaxed)) {
            }
        }
    }
    loop.finished.fetch_add(1, std::memory_order_release);
}

}  // namespace

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
    Loop loop;
    loop.count = count;
    loop.grain = grain;
    loop.body = &body;
    if (!arena_ || chunks < 2) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
            loop.run_chunk(chunk);
        }
        return;
    }
    // Every chunk before one that has thrown runs, so that the exception that leaves is always the
    // lowest chunk's, as on one thread.
    loop.failures.resize(chunks);
    loop.has_started.store(true, std::memory_order_release);
    arena_->run(chunks, run_chunk_of, &loop);
    const std::size_t finished = loop.finished.load(std::memory_order_acquire);
    EARSHOT_ASSERT(finished == chunks);
    static_cast<void>(finished);
    for (const std::exception_ptr& failure : loop.failures) {
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
