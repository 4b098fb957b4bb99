// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"
#include "earshot/propagation/second_order_diffraction.h"

#include <array>
#include <cmath>
#include <optional>

namespace earshot::propagation {

/// The length of the hypotenuse, with the same bits everywhere.
inline double diagonal(double a, double b) noexcept {
    return std::sqrt(a * a + b * b);
}

/// The line of an edge in the coordinates of another: what the points of the one are about the
/// other. All but the angle are linear or the root of a square in the place along the line.
class LineAbout {
public:
    /// `fixed_angle`: of a line in a face, whose angle rounding must not decide.
    LineAbout(const geometry::Wedge& axis,
              const geometry::Wedge& line,
              std::optional<double> fixed_angle) noexcept;

    double radius(double z) const noexcept { return std::sqrt(radius_squared(z)); }
    /// Metres along the axis.
    double axial(double z) const noexcept { return axial_ + axial_slope_ * z; }
    double axial_slope() const noexcept { return axial_slope_; }
    /// Of the radius far away: 0 for parallel lines.
    double radius_slope() const noexcept { return diagonal(x_slope_, y_slope_); }
    /// Half the derivative of the squared radius.
    double radius_slope_product(double z) const noexcept {
        return (x_ + x_slope_ * z) * x_slope_ + (y_ + y_slope_ * z) * y_slope_;
    }
    /// The difference of the squared radii at two places over the difference of the places.
    double radius_squared_quotient(double z, double other) const noexcept {
        return radius_slope_product(z) + radius_slope_product(other);
    }
    double angle(double z) const noexcept;
    /// The place in an interval that is closest to the axis; its beginning if the lines are
    /// parallel.
    double closest_in(const geometry::Interval& part) const noexcept;
    /// Where the line meets the half-plane of an angle, or that opposite to it.
    double place_at(double angle) const noexcept;
    bool has_fixed_angle() const noexcept { return fixed_angle_.has_value(); }

    geometry::WedgePoint at(double z) const noexcept { return {radius(z), angle(z), axial(z)}; }

private:
    double radius_squared(double z) const noexcept {
        const double x = x_ + x_slope_ * z;
        const double y = y_ + y_slope_ * z;
        return x * x + y * y;
    }

    // At the line's beginning, and per metre of it: along the first face, its normal and the axis.
    double x_ = 0.0, y_ = 0.0, axial_ = 0.0;
    double x_slope_ = 0.0, y_slope_ = 0.0, axial_slope_ = 0.0;
    std::optional<double> fixed_angle_{};
};

/// The length of the shortest way from one end over any point of the line of the inner edge to a
/// place on the outer edge and on to the other end, as a function of that place. It is convex.
class ReducedLength {
public:
    /// `inner`: the one end about the inner edge; `outer`: the other about the outer edge.
    ReducedLength(const geometry::WedgePoint& inner,
                  const LineAbout& outer_about_inner,
                  const geometry::WedgePoint& outer) noexcept
        : inner_(inner), line_(outer_about_inner), outer_(outer) {}

    /// Where the length has a value. `side`: +1 for the larger of both places, -1 for the smaller.
    /// Precondition: the value is not below the minimum, but for rounding.
    double place_of(double length, double side) const noexcept;

    double value(double z) const noexcept { return before(z) + after(z); }
    double slope(double z) const noexcept;
    /// The length to the place and the rest of the way.
    double before(double z) const noexcept {
        return diagonal(inner_.radius + line_.radius(z), line_.axial(z) - inner_.z);
    }
    double after(double z) const noexcept { return diagonal(outer_.radius, z - outer_.z); }

    const LineAbout& line() const noexcept { return line_; }
    const geometry::WedgePoint& inner() const noexcept { return inner_; }
    const geometry::WedgePoint& outer() const noexcept { return outer_; }

private:
    geometry::WedgePoint inner_;
    LineAbout line_;
    geometry::WedgePoint outer_;
};

/// The two places on an axis from which the distances to two points add up to a length; nothing if
/// none is so short.
std::optional<geometry::Interval> places_of_length(const geometry::WedgePoint& from,
                                                   const geometry::WedgePoint& to,
                                                   double length) noexcept;

/// Two edges in the coordinates that their double integral is computed in. z[0] is metres along the
/// first edge, z[1] along the second.
class EdgePairGeometry {
public:
    explicit EdgePairGeometry(const DoubleDiffraction& edges) noexcept;

    /// As a function of the place on the second edge: over the first.
    const ReducedLength& over_first() const noexcept { return over_first_; }
    const ReducedLength& over_second() const noexcept { return over_second_; }
    const LineAbout& second_about_first() const noexcept { return over_first_.line(); }
    const LineAbout& first_about_second() const noexcept { return over_second_.line(); }
    const geometry::WedgePoint& source() const noexcept { return over_first_.inner(); }
    const geometry::WedgePoint& listener() const noexcept { return over_second_.inner(); }

    /// The part of an edge, 0 or 1.
    const geometry::Interval& part(std::size_t edge) const noexcept { return parts_[edge]; }

    /// Metres between points of the edges.
    double link(const std::array<double, 2>& z) const noexcept {
        return diagonal(second_about_first().radius(z[1]), second_about_first().axial(z[1]) - z[0]);
    }
    /// Of the whole way over both points.
    double length(const std::array<double, 2>& z) const noexcept {
        return over_second_.after(z[0]) + link(z) + over_first_.after(z[1]);
    }
    /// The points of both parts that are closest to each other.
    std::array<double, 2> closest_points() const noexcept { return closest_points(parts_); }
    /// The same of other parts.
    std::array<double, 2> closest_points(
        const std::array<geometry::Interval, 2>& parts) const noexcept;

private:
    std::array<geometry::Interval, 2> parts_;
    ReducedLength over_first_;
    ReducedLength over_second_;
};

}  // namespace earshot::propagation
