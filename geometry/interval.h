// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

namespace earshot::geometry {

/// A closed interval of the parameter t along a line; empty if min > max.
struct Interval {
    double min = 0.0;
    double max = 1.0;

    bool is_empty() const noexcept { return min > max; }
};

}  // namespace earshot::geometry
