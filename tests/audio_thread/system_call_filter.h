// SPDX-License-Identifier: MIT
#pragma once

namespace earshot::test {

/// From now on every system call of this thread but the end of the thread is refused and recorded
/// (seccomp filter). False if the kernel has no such filter.
bool refuse_system_calls() noexcept;

/// Of all threads that refuse them: how many, and the number of the first.
struct RefusedCalls {
    int count = 0;
    long first = -1;
};
RefusedCalls refused_calls() noexcept;
void clear_refused_calls() noexcept;

/// Ends a thread that refuses system calls: returning from its function would make some.
[[noreturn]] void end_thread() noexcept;

}  // namespace earshot::test
