// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/geometry/types.h"
#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/directions.h"

#include <cmath>
#include <cstddef>

namespace earshot::visibility {

/// One face of a cube around a point, divided into pixels.
class CubeFace {
public:
    static constexpr std::size_t kFaces = 6;

    /// `pixels`: their number along an edge.
    CubeFace(std::size_t face, std::size_t pixels) noexcept
        : step_(2.0 / static_cast<double>(pixels)) {
        const auto axis = static_cast<int>(face / 2);
        front_[axis] = face % 2 == 0 ? 1.0 : -1.0;
        right_[(axis + 1) % 3] = 1.0;
        up_[(axis + 2) % 3] = 1.0;
    }

    /// The unit vector of a position on the face, in pixels; half-integers are middles of pixels.
    /// Off the face it continues over the edge.
    geometry::Vec3 direction(double column, double row) const noexcept {
        return geometry::normalized(front_ + at(column) * right_ + at(row) * up_);
    }

    /// The signed solid angle of the rectangle between the face's middle and a corner of pixels:
    /// that of a pixel is the mixed difference over its corners.
    double corner_angle(std::size_t column, std::size_t row) const noexcept {
        const double x = at(static_cast<double>(column)), y = at(static_cast<double>(row));
        return math::atan2(x * y, std::sqrt(x * x + y * y + 1.0));
    }

private:
    double at(double steps) const noexcept { return steps * step_ - 1.0; }

    double step_;
    geometry::Vec3 front_{0.0}, right_{0.0}, up_{0.0};
};

}  // namespace earshot::visibility
