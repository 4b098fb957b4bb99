// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace bench {

/// What earshot's parallel loops did: where there are many chunks and none is long, more threads
/// help. Times are processor times.
struct LoopCounts {
    std::size_t loops = 0;  ///< calls of Executor::for_each, of those inside others not counted
    std::size_t max_chunks = 0;  ///< of a loop
    double in_loops = 0.0;       ///< seconds in all chunks
    double bound_64 = 0.0;       ///< seconds in loops on 64 threads at best: for every loop its
                                 ///< longest chunk, or the time of all by 64 if that is more
    double all = 0.0;            ///< seconds in loops and outside
};

/// Does a work whose loops are divided as its executor asks. All chunks run one after another on
/// the calling thread, so that an executor may have more threads than the machine has cores.
LoopCounts count_loops(const std::function<void()>& work);

}  // namespace bench
