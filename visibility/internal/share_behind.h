// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/internal/cell_leaf.h"

#include <array>
#include <span>
#include <vector>

namespace earshot::visibility {

/// How much of a leaf, and of its viewers, is behind planes of one direction.
class ShareBehind {
public:
    /// Without viewers their share is that of the volume.
    ShareBehind(const CellLeaf& leaf,
                std::span<const Viewer> viewers,
                const geometry::Vec3& normal);

    /// Cubic metres. Exact but for rounding.
    double volume(double offset) const noexcept;
    /// Of all viewers, given the volume behind the same plane.
    double share(double offset, double volume_behind) const noexcept;

private:
    /// A part of the surface: where its corners are along the normal, relative to the lowest
    /// corner, ascending, and its area as seen along the normal, positive for outward.
    struct Patch {
        std::array<double, 3> heights;
        double area;
    };

    const CellLeaf& leaf_;
    double lowest_ = 0.0, highest_ = 0.0;
    std::vector<Patch> patches_;
    bool has_viewers_;
    std::vector<double> viewer_heights_;  // ascending
    std::vector<double> viewer_sums_;     // shares of the viewers before each, and of all
};

}  // namespace earshot::visibility
