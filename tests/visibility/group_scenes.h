// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/mesh.h"
#include "earshot/geometry/types.h"
#include "earshot/visibility/internal/viewer_region.h"

#include <glm/common.hpp>

#include "support/dice.h"
#include <array>
#include <cmath>
#include <cstddef>

namespace earshot::visibility {

/// Where a random case lies, and how large it is.
struct Placement {
    geometry::Vec3 centre{0.0};
    double scale = 1.0;

    geometry::Vec3 point(support::Dice& dice) const {
        const double x = dice.between(-1.0, 1.0);
        const double y = dice.between(-1.0, 1.0);
        return centre + scale * geometry::Vec3(x, y, dice.between(-1.0, 1.0));
    }
    double max_abs_coordinate() const { return 40.0 * scale + 2e6; }
};

inline Placement random_placement(support::Dice& dice) {
    static constexpr std::array<double, 6> kScales{1.0, 10.0, 1e-3, 1e4, 1e-8, 1.0};
    static constexpr std::array<double, 3> kOffsets{0.0, 0.0, 1e6};
    const double offset = kOffsets[static_cast<std::size_t>(dice.below(3))];
    return {.centre = geometry::Vec3(offset, -0.5 * offset, 0.25 * offset),
            .scale = kScales[static_cast<std::size_t>(dice.below(6))]};
}

/// A box of any size, flat or a point at times.
inline geometry::Aabb random_box(support::Dice& dice, const Placement& placement) {
    const geometry::Vec3 middle = placement.point(dice);
    geometry::Vec3 half{0.0};
    for (int axis = 0; axis < 3; ++axis) {
        half[axis] =
            dice.chance(0.3) ? 0.0 : placement.scale * std::pow(10.0, dice.between(-4, -1));
    }
    geometry::Aabb box;
    box.include(middle - half);
    box.include(middle + half);
    return box;
}

/// A point of a box, a corner of it at times.
inline geometry::Vec3 random_point(support::Dice& dice, const geometry::Aabb& box) {
    geometry::Vec3 point{0.0};
    const bool is_corner = dice.chance(0.7);
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const auto lower = static_cast<double>(box.lower[k]);
        const auto upper = static_cast<double>(box.upper[k]);
        point[axis] = is_corner ? (dice.chance(0.5) ? lower : upper) : dice.between(lower, upper);
    }
    return glm::clamp(point,
                      geometry::Vec3(box.lower[0], box.lower[1], box.lower[2]),
                      geometry::Vec3(box.upper[0], box.upper[1], box.upper[2]));
}

inline ViewerRegion random_region(support::Dice& dice, const Placement& placement) {
    const geometry::Vec3 from = placement.point(dice);
    if (dice.chance(0.3)) {
        return ViewerRegion(from);
    }
    const geometry::Vec3 to = from + dice.between(0.0, 0.3) * (placement.point(dice) - from);
    return {from, to, dice.between(0.0, 0.03) * placement.scale};
}

/// A viewer that the region contains: at an end, or along the way and aside.
inline geometry::Vec3 random_viewer(support::Dice& dice, const ViewerRegion& region) {
    const geometry::Vec3 from = region.begin_ball().centre;
    const geometry::Vec3 to = region.end_ball().centre;
    for (int attempt = 0; attempt < 20; ++attempt) {
        const double along = dice.chance(0.5) ? dice.below(2) : dice.between(0.0, 1.0);
        geometry::Vec3 viewer = from + along * (to - from);
        for (int axis = 0; axis < 3; ++axis) {
            const double side = dice.chance(0.5) ? 0.998 : dice.between(0.0, 1.0);
            viewer[axis] += (dice.chance(0.5) ? side : -side) * region.begin_ball().radius;
        }
        if (region.contains(viewer)) {
            return viewer;
        }
    }
    return from;
}

}  // namespace earshot::visibility
