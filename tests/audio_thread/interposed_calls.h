// SPDX-License-Identifier: MIT
#pragma once

namespace earshot::test {

/// Calls that a thread made while it was watched.
struct WatchedCalls {
    int count = 0;
    const char* first = "";  ///< the name of the first
};

/// While one exists, the calls of this thread to the allocator and to locks are counted: this
/// program has its own malloc(), free(), pthread_mutex_lock() and so on, which libraries call too.
class CallWatch {
public:
    CallWatch() noexcept;
    ~CallWatch();
    CallWatch(const CallWatch&) = delete;
    CallWatch& operator=(const CallWatch&) = delete;

    /// Of this thread, since the program began.
    static WatchedCalls calls() noexcept;
    /// Whether they are counted: not where a sanitizer has its own malloc().
    static bool is_available() noexcept;
};

}  // namespace earshot::test
