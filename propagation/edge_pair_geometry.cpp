// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/edge_pair_geometry.h"

#include "earshot/base/math.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace earshot::propagation {

using geometry::Interval;
using geometry::Vec3;
using geometry::Wedge;
using geometry::WedgePoint;

namespace {

/// The angle of a face that a way between the edges runs along.
std::optional<double> face_angle(const Wedge& wedge, const DoubleDiffraction& edges, int face) {
    if (!edges.common_face) {
        return std::nullopt;
    }
    return face == 0 ? 0.0 : wedge.open_angle;
}

}  // namespace

LineAbout::LineAbout(const Wedge& axis,
                     const Wedge& line,
                     std::optional<double> fixed_angle) noexcept
    : fixed_angle_(fixed_angle) {
    const Vec3 offset = line.begin - axis.begin;
    x_ = glm::dot(offset, axis.tangent);
    y_ = glm::dot(offset, axis.normal);
    axial_ = glm::dot(offset, axis.direction);
    x_slope_ = glm::dot(line.direction, axis.tangent);
    y_slope_ = glm::dot(line.direction, axis.normal);
    axial_slope_ = glm::dot(line.direction, axis.direction);
    // Parallel lines.
    constexpr double kMinSlope = 1e-13;
    if (!fixed_angle_ && std::abs(x_slope_) + std::abs(y_slope_) < kMinSlope) {
        fixed_angle_ = geometry::wedge_coordinates(axis, line.begin).angle;
    }
}

double LineAbout::angle(double z) const noexcept {
    if (fixed_angle_) {
        return *fixed_angle_;
    }
    const double angle = math::atan2(y_ + y_slope_ * z, x_ + x_slope_ * z);
    return angle < 0.0 ? angle + 2.0 * math::kPi : angle;
}

double LineAbout::closest_in(const Interval& part) const noexcept {
    const double slope_squared = x_slope_ * x_slope_ + y_slope_ * y_slope_;
    return slope_squared > 0.0
               ? std::clamp(-(x_ * x_slope_ + y_ * y_slope_) / slope_squared, part.min, part.max)
               : part.min;
}

double LineAbout::place_at(double angle) const noexcept {
    const double sine = math::sin(angle), cosine = math::cos(angle);
    return (y_ * cosine - x_ * sine) / (x_slope_ * sine - y_slope_ * cosine);
}

double ReducedLength::slope(double z) const noexcept {
    const double radius = line_.radius(z);
    const double radius_slope = radius > 0.0 ? line_.radius_slope_product(z) / radius : 0.0;
    const double rise = line_.axial(z) - inner_.z;
    return ((inner_.radius + radius) * radius_slope + rise * line_.axial_slope()) / before(z) +
           (z - outer_.z) / after(z);
}

// Newton's method from outside comes closer to the root of a convex function from one side.
double ReducedLength::place_of(double length, double side) const noexcept {
    const double radius = outer_.radius;
    double z = outer_.z + side * std::sqrt(std::max(0.0, length * length - radius * radius));
    constexpr int kMaxSteps = 60;
    for (int step = 0; step < kMaxSteps; ++step) {
        const double steepness = side * slope(z);
        const double excess = value(z) - length;
        if (!(steepness > 0.0) || !(excess > 0.0)) {
            break;
        }
        const double next = z - side * excess / steepness;
        if (!(side * next < side * z)) {
            break;
        }
        z = next;
    }
    return z;
}

// With x counted from the first point and D the rise to the second, m + M = L and
// m^2 - M^2 = rs^2 - r^2 + 2 x D - D^2 give m = (K + D x) / L, K = (L^2 + rs^2 - r^2 - D^2) / 2,
// and m^2 = rs^2 + x^2 a quadratic equation for x.
std::optional<Interval> places_of_length(const WedgePoint& from,
                                         const WedgePoint& to,
                                         double length) noexcept {
    const double rise = to.z - from.z;
    const double shortest = diagonal(from.radius + to.radius, rise);
    const double excess = (length - shortest) * (length + shortest);
    if (!(excess > 0.0)) {
        return std::nullopt;
    }
    const double root = 0.5 * std::sqrt(excess * (excess + 4.0 * from.radius * to.radius));
    const double squares = length * length - rise * rise;
    const double middle =
        0.5 * (squares + from.radius * from.radius - to.radius * to.radius) * rise;
    return Interval{from.z + (middle - length * root) / squares,
                    from.z + (middle + length * root) / squares};
}

EdgePairGeometry::EdgePairGeometry(const DoubleDiffraction& edges) noexcept
    : parts_{Interval{edges.first_begin, edges.first_end},
             Interval{edges.second_begin, edges.second_end}},
      over_first_(
          geometry::wedge_coordinates(edges.first, edges.source),
          LineAbout(
              edges.first,
              edges.second,
              face_angle(edges.first, edges, edges.common_face ? edges.common_face->of_first : 0)),
          geometry::wedge_coordinates(edges.second, edges.listener)),
      over_second_(
          geometry::wedge_coordinates(edges.second, edges.listener),
          LineAbout(edges.second,
                    edges.first,
                    face_angle(
                        edges.second, edges, edges.common_face ? edges.common_face->of_second : 0)),
          geometry::wedge_coordinates(edges.first, edges.source)) {}

// The squared distance is a convex quadratic function: if its minimum is not in the rectangle of
// both parts, it is smallest on one of the sides.
std::array<double, 2> EdgePairGeometry::closest_points(
    const std::array<Interval, 2>& parts) const noexcept {
    const auto on_first = [&](double second) {
        return std::clamp(second_about_first().axial(second), parts[0].min, parts[0].max);
    };
    const auto on_second = [&](double first) {
        return std::clamp(first_about_second().axial(first), parts[1].min, parts[1].max);
    };
    // Both points are the foot of the other.
    const double slope = second_about_first().axial_slope();
    const double sine_squared = 1.0 - slope * slope;
    std::array<double, 2> closest{parts[0].min, on_second(parts[0].min)};
    const auto consider = [&](const std::array<double, 2>& z) {
        if (link(z) < link(closest)) {
            closest = z;
        }
    };
    consider({parts[0].max, on_second(parts[0].max)});
    consider({on_first(parts[1].min), parts[1].min});
    consider({on_first(parts[1].max), parts[1].max});
    if (sine_squared > 0.0) {
        const double foot =
            (second_about_first().axial(0.0) + slope * first_about_second().axial(0.0)) /
            sine_squared;
        if (foot > parts[0].min && foot < parts[0].max) {
            consider({foot, on_second(foot)});
        }
    }
    return closest;
}

}  // namespace earshot::propagation
