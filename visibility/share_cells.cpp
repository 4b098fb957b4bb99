// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/share_cells.h"

#include "earshot/base/math.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::visibility {

using geometry::Vec3;

ParameterCell ParameterCell::quarter(std::size_t index) const noexcept {
    const double u = 0.5 * (u0 + u1);
    const double v = 0.5 * (v0 + v1);
    ParameterCell part = *this;
    (index % 2 == 0 ? part.u1 : part.u0) = u;
    (index / 2 == 0 ? part.v1 : part.v0) = v;
    return part;
}

SphereCells::SphereCells(const Vec3& from, const SphereTarget& target) noexcept
    : from_(from),
      axis_(geometry::direction_between(from, target.centre)),
      distance_(glm::distance(from, target.centre)),
      radius_(target.radius) {
    // The coordinate axis that is farthest from it gives a direction at right angles.
    const Vec3 size(std::abs(axis_.x), std::abs(axis_.y), std::abs(axis_.z));
    const Vec3 other = size.x <= size.y && size.x <= size.z ? Vec3(1, 0, 0)
                       : size.y <= size.z                   ? Vec3(0, 1, 0)
                                                            : Vec3(0, 0, 1);
    right_ = geometry::normalized(glm::cross(axis_, other));
    up_ = glm::cross(right_, axis_);
    const double sine = std::min(1.0, radius_ / distance_);
    cosine_ = std::sqrt(std::max(0.0, 1.0 - sine * sine));
}

double SphereCells::cosine_at(double v) const noexcept {
    return 1.0 - v * (1.0 - cosine_);
}

// Along the axis, of the point where the direction meets the ball first; it grows with the angle.
double SphereCells::depth_at(double cosine) const noexcept {
    const double sine_squared = std::max(0.0, 1.0 - cosine * cosine);
    const double half_chord =
        std::sqrt(std::max(0.0, radius_ * radius_ - distance_ * distance_ * sine_squared));
    return (distance_ * cosine - half_chord) * cosine;
}

Vec3 SphereCells::point(double u, double v) const noexcept {
    const double cosine = cosine_at(v);
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const double turn = 2.0 * math::kPi * u;
    const Vec3 towards = cosine * axis_ + sine * (math::cos(turn) * right_ + math::sin(turn) * up_);
    return from_ + depth_at(cosine) / cosine * towards;
}

CellHull SphereCells::hull(const ParameterCell& cell) const noexcept {
    // In the plane at distance 1 the cell is a part of a ring: within the chord of its inner arc
    // and the tangent of its outer one.
    const double inner = cosine_at(cell.v0);
    const double outer = cosine_at(cell.v1);
    const auto tangent = [](double cosine) {
        return std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
    };
    const double half_turn = math::kPi * (cell.u1 - cell.u0);
    constexpr double kOutward = 1.0 + 1e-12;  // more than the rounding of what follows
    const double low = tangent(inner) / kOutward;
    const double high = tangent(outer) / math::cos(half_turn) * kOutward;
    const auto direction = [&](double u, double radius) {
        const double turn = 2.0 * math::kPi * u;
        return axis_ + radius * (math::cos(turn) * right_ + math::sin(turn) * up_);
    };
    const std::array<Vec3, 4> directions = {direction(cell.u0, low),
                                            direction(cell.u0, high),
                                            direction(cell.u1, high),
                                            direction(cell.u1, low)};
    CellHull hull;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        hull.near[corner] = from_ + depth_at(inner) / kOutward * directions[corner];
        hull.far[corner] = from_ + depth_at(outer) * kOutward * directions[corner];
    }
    return hull;
}

CellHull ParallelogramCells::hull(const ParameterCell& cell) const noexcept {
    CellHull hull;
    hull.far = {point(cell.u0, cell.v0),
                point(cell.u1, cell.v0),
                point(cell.u1, cell.v1),
                point(cell.u0, cell.v1)};
    hull.near = hull.far;
    return hull;
}

}  // namespace earshot::visibility
