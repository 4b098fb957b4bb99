// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/pose.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::propagation {

/// What the control thread tells the update thread.
struct ControlState {
    std::int64_t frame = 0;                                   ///< at which it was published
    double scene_time = 0.0;                                  ///< seconds
    std::vector<std::optional<Pose>> sources{}, listeners{};  ///< where the scene has them: nothing
};

}  // namespace earshot::propagation
