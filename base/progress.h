// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <functional>
#include <string_view>

namespace earshot {

/// Told about long work as it goes on. Called from one thread at a time, at least once at the end
/// of each stage (done == total).
class Progress {
public:
    virtual ~Progress() = default;
    virtual void report(std::string_view stage, std::size_t done, std::size_t total) = 0;
};

/// Asked now and then while long work goes on, from any of its threads; true: stop.
using Interrupt = std::function<bool()>;

}  // namespace earshot
