// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/whole_file.h"

#include <cstddef>
#include <functional>
#include <string>

namespace earshot::io {

/// What a child process may use.
struct ChildLimits {
    double processor_time = 15.0;  ///< seconds
    double time = 30.0;            ///< seconds
    /// Bytes of memory beside what this process has. Not enforced under the address and thread
    /// sanitizers, which reserve far more than any program uses.
    std::size_t memory = std::size_t{1} << 31U;
    std::size_t output = std::size_t{1} << 30U;  ///< bytes that it may hand back
};

/// How a child process ended.
enum class ChildEnd {
    finished,
    failed,       ///< its work threw
    crashed,      ///< by a signal
    time,         ///< it took more time than it may
    memory,       ///< its work threw std::bad_alloc, or the system ended it for want of memory
    output,       ///< it handed back more than it may
    not_started,  ///< the system starts no process
};

struct ChildResult {
    ChildEnd end = ChildEnd::not_started;
    std::string output;  ///< what was handed back until then
};

/// Does `work` in a child process and collects what it gives to the sink: for third-party parsers
/// of files that nobody vouches for, whose crashes and endless loops then end the child alone.
///
/// The child is a fork without exec. Where this process has other threads, `work` may do what is
/// safe after fork with the GNU C library: allocate memory and call the system, but neither take a
/// lock that another thread may hold nor start threads. A child that deadlocks nevertheless ends
/// with its time. Its standard error is closed to what the third party prints, except under
/// sanitizers, whose reports are wanted.
ChildResult run_in_child(const ChildLimits& limits,
                         const std::function<void(const ByteSink&)>& work);

}  // namespace earshot::io
