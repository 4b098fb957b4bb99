// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <functional>
#include <memory>

namespace earshot {

class Arena;

/// Where loops run. Chunk borders depend on `count` and `grain` only, never on the number of
/// threads, so a reduction joined in chunk order gives the same bits on any machine.
class Executor {
public:
    /// 0: one thread per core; 1: everything on the calling thread. Throws Error if negative.
    explicit Executor(int threads = 0);
    ~Executor();
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

    int threads() const noexcept { return threads_; }

    /// Calls body(begin, end) once per chunk of at most `grain` items and waits. Chunks run in any
    /// order and at the same time. If several throw, the lowest chunk's exception is rethrown.
    void for_each(std::size_t count,
                  std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

    /// The executor that runs everything on the calling thread.
    static Executor& serial();

private:
    int threads_;
    std::unique_ptr<Arena> arena_;
};

/// Number of chunks that for_each makes of `count` items.
constexpr std::size_t chunk_count(std::size_t count, std::size_t grain) noexcept {
    return (count + grain - 1) / grain;
}

}  // namespace earshot
