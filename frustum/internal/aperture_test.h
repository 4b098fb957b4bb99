// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace earshot::frustum {

/// Eight points side by side; unused ones have coordinates that are not numbers.
struct alignas(64) PointBlock {
    static constexpr std::size_t kWidth = 8;
    double coordinate[3][kWidth];
};

/// An aperture of a frustum, grown so far that no point that may be visible through it is left out:
/// a point p, in the frustum's axes, is inside if lower z - m <= x <= upper z + m for m =
/// margin_per_depth * z + margin, and likewise in y, and z > min_depth.
struct ApertureTest {
    double apex[3] = {};
    double axes[3][3] = {};  ///< right, up, forward
    double lower[2] = {}, upper[2] = {};
    double margin_per_depth[2] = {};
    double margin = 0.0;  ///< metres
    double min_depth = 0.0;
};

/// Sets bit i of masks[k] if point i of block k is inside the aperture. The same bits on every
/// instruction set. Precondition: masks.size() == blocks.size().
void find_points_inside(const ApertureTest& aperture,
                        std::span<const PointBlock> blocks,
                        std::span<std::uint8_t> masks) noexcept;

}  // namespace earshot::frustum
