// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/internal/cell_leaf.h"

#include <array>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The volume of a leaf behind planes of one normal, and the fraction of the viewers there.
class VolumeBehindPlane {
public:
    /// Without viewers their fraction is that of the volume.
    VolumeBehindPlane(const CellLeaf& leaf,
                      std::span<const Viewer> viewers,
                      const geometry::Vec3& normal);

    /// The volume behind the plane of an offset, cubic metres. Exact but for rounding.
    double volume(double offset) const noexcept;
    /// The fraction of all viewers behind the plane, given the volume behind the same plane.
    double viewer_fraction(double offset, double volume_behind) const noexcept;

private:
    /// A triangle of the surface: the heights of its corners along the normal, relative to the
    /// lowest corner of the leaf, ascending, and its area projected along the normal, positive if
    /// it faces that way.
    struct Patch {
        std::array<double, 3> heights;
        double area;
    };

    const CellLeaf& leaf_;
    double lowest_ = 0.0, highest_ = 0.0;
    std::vector<Patch> patches_;
    bool has_viewers_;
    std::vector<double> viewer_heights_;  // ascending
    std::vector<double>
        viewer_sums_;  // cumulative fractions; the last one is of all viewers in the leaf
};

}  // namespace earshot::visibility
