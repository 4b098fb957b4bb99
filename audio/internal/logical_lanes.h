// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace earshot::audio {

/// Kernels work on this many logical lanes on every instruction set; rows are padded to them.
inline constexpr std::size_t kLanes = 8;

constexpr std::size_t padded(std::size_t count) noexcept {
    return (count + kLanes - 1) / kLanes * kLanes;
}

}  // namespace earshot::audio
