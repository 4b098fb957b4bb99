// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>

namespace earshot {

/// oneTBB's threads behind a plain function pointer, so that no header of it is needed elsewhere
/// and arena.cpp can be compiled without the thread sanitizer: the sanitizer cannot look into
/// oneTBB's library and takes all that its headers do for races.
class Arena {
public:
    explicit Arena(int threads);
    ~Arena();
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;

    /// Calls task(context, i) for every i < count, in any order and at the same time, and waits.
    /// The task must not throw.
    void run(std::size_t count, void (*task)(void* context, std::size_t i), void* context);

private:
    struct Threads;
    std::unique_ptr<Threads> threads_;
};

}  // namespace earshot
