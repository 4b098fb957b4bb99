// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::frustum {

/// Eight points side by side; what is not a number stands for no point.
struct alignas(64) PointBlock {
    static constexpr std::size_t kWidth = 8;
    double coordinate[3][kWidth];
};

/// A window of a frustum, grown so far that no point that may be seen through it is left out: a
/// point p, in the frustum's axes, is in sight if lower z - room <= x <= upper z + room for room =
/// share * z + reach, and likewise in y, and z > least_depth.
struct WindowSight {
    double apex[3] = {};
    double axes[3][3] = {};  ///< right, up, forward
    double lower[2] = {}, upper[2] = {};
    double share[2] = {};
    double reach = 0.0;
    double least_depth = 0.0;
};

/// Sets bit i of masks[k] if point i of block k is in sight. The same bits on every instruction
/// set. Precondition: masks.size() == blocks.size().
void find_in_sight(const WindowSight& sight,
                   std::span<const PointBlock> blocks,
                   std::span<std::uint8_t> masks) noexcept;

}  // namespace earshot::frustum
