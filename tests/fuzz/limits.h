// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace earshot::test {

inline constexpr int kMaxInputSeconds = 30;  ///< processor time of one input
inline constexpr std::size_t kMaxInputBytes = std::size_t{2} << 30U;  ///< memory of one input

/// Whether the program runs under the address sanitizer, which maps terabytes of shadow memory.
bool has_address_sanitizer();

/// From now on memory beyond kMaxInputBytes more than the process holds is refused: std::bad_alloc.
/// Without effect under the address sanitizer, which has options of its own for that.
void limit_memory();

/// The process dies by SIGPROF if it takes kMaxInputSeconds from now without another call.
void restart_time_limit();

/// Processor seconds of the process so far.
double processor_seconds();

}  // namespace earshot::test
