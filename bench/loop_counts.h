// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace bench {

/// What earshot's parallel loops did: where there are many chunks and none is long, more threads
/// help. Times are processor times of the threads that worked.
struct LoopCounts {
    std::size_t loops = 0;  ///< calls of Executor::for_each, of those inside others not counted
    std::size_t max_chunks = 0;  ///< of a loop
    double in_loops = 0.0;       ///< seconds in all chunks
    double bound_64 = 0.0;       ///< seconds in loops on 64 threads at best: for every loop its
                                 ///< longest chunk, or the time of all by 64 if that is more
};

/// Counts from now on.
void reset_loop_counts();
LoopCounts loop_counts();

}  // namespace bench
