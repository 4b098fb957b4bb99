// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/scene.h"

#include <cstddef>
#include <string>

namespace earshot::io {

/// `{"source": "s", "listener": "l", "time": 0.0` without the closing brace.
std::string pair_head(const propagation::Scene& scene,
                      std::size_t source,
                      std::size_t listener,
                      double time);

}  // namespace earshot::io
