// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/geometry/types.h"

#include <cstddef>
#include <vector>

namespace earshot::capi {

/// The segments of two arrays (count, 3). Throws Failure for ends that are not finite.
std::vector<geometry::Segment> segments_of(const double* from,
                                           const double* to,
                                           std::size_t count,
                                           Executor& executor);

}  // namespace earshot::capi
