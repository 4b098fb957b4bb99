// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>

namespace earshot::propagation {

/// Standard errors of one listener's late sound, the larger of 500 Hz and 1 kHz. First-order
/// estimates from the spread of the batches; 0 with a single batch.
struct LateErrors {
    std::size_t rays = 0;   ///< behind the histogram
    double t30 = 0.0;       ///< relative; 0 also where the late sound does not decay by 35 dB
    double level_db = 0.0;  ///< of all late sound
    bool reached = true;    ///< RayOptions::max_error, if it was asked for
};

}  // namespace earshot::propagation
