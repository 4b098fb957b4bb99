// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/level_curve.h"

#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::propagation {

using geometry::Interval;
using geometry::WedgePoint;

namespace {

constexpr double kTurn = 2.0 * math::kPi;

/// Where the way over the line of the first edge meets it.
double apex(const WedgePoint& before, const WedgePoint& after) noexcept {
    return (before.z * after.radius + after.z * before.radius) / (before.radius + after.radius);
}

/// How much longer the reduced length is at `turn` than at a place that is `step` metres away,
/// without cancellation.
double drop(const ReducedLength& length, double turn, double step) noexcept {
    const double z = turn - step;
    const LineAbout& line = length.line();
    const double radius = line.radius(z), radius_at_turn = line.radius(turn);
    const double rise = line.axial(z) - length.inner().z;
    const double rise_at_turn = line.axial(turn) - length.inner().z;
    const double radii = radius + radius_at_turn;
    const double of_radius =
        radii > 0.0 ? step * line.radius_squared_quotient(z, turn) / radii : 0.0;
    const double of_rise = step * line.axial_slope();
    const double before =
        (of_radius * (2.0 * length.inner().radius + radii) + of_rise * (rise + rise_at_turn)) /
        (length.before(z) + length.before(turn));
    const double after =
        step * (z + turn - 2.0 * length.outer().z) / (length.after(z) + length.after(turn));
    return before + after;
}

}  // namespace

LevelCurve::LevelCurve(const EdgePairGeometry& edges, double length) noexcept
    : edges_(edges), length_(length) {
    lower_ = edges.over_first().place_of(length, -1.0);
    upper_ = std::max(lower_, edges.over_first().place_of(length, 1.0));
    middle_ = 0.5 * (lower_ + upper_);
    half_width_ = 0.5 * (upper_ - lower_);
}

LevelCurve::Point LevelCurve::at(double t) const noexcept {
    const double sine = math::sin(t);
    const double cosine = math::cos(t);
    const double side = sine > 0.0 ? 1.0 : -1.0;
    // The distance from the closer turn, half_width (1 - |sin t|).
    const double step = half_width_ * cosine * cosine / (1.0 + std::abs(sine));
    const double z = turn(side) - side * step;
    const ReducedLength& over_first = edges_.over_first();
    const WedgePoint& source = edges_.source();
    const double radius = edges_.second_about_first().radius(z);
    const double rise = edges_.second_about_first().axial(z) - source.z;
    const double shortest = over_first.before(z);
    const double after = over_first.after(z);
    const double excess_length = std::max(drop(over_first, turn(side), side * step), 0.0);
    const double before = shortest + excess_length;
    // As in places_of_length().
    const double excess = excess_length * (before + shortest);
    const double product = 4.0 * source.radius * radius;
    const double root = 0.5 * std::sqrt(excess * (excess + product));
    const double squares = before * before - rise * rise;
    const double middle = 0.5 * (squares + source.radius * source.radius - radius * radius) * rise;
    Point point;
    point.z = {source.z + (middle + std::copysign(before * root, cosine)) / squares, z};
    constexpr double kTiny = std::numeric_limits<double>::min();
    const double squared_sinh = excess / std::max(product, kTiny);
    point.first_root = std::sqrt(squared_sinh) + std::sqrt(1.0 + squared_sinh);
    point.measure = half_width_ * std::abs(cosine) / (after * std::max(root, kTiny));
    return point;
}

double LevelCurve::angle_of(const std::array<double, 2>& z) const noexcept {
    const double sine = std::clamp((z[1] - middle_) / half_width_, -1.0, 1.0);
    const double angle = math::atan2(sine, std::sqrt((1.0 - sine) * (1.0 + sine)));
    const double turn = apex(
        edges_.source(),
        {edges_.second_about_first().radius(z[1]), 0.0, edges_.second_about_first().axial(z[1])});
    return z[0] >= turn ? angle : math::kPi - angle;
}

double LevelCurve::extreme_of_first(double side) const noexcept {
    const double first = edges_.over_second().place_of(length_, side);
    const LineAbout& line = edges_.first_about_second();
    const double second =
        apex({line.radius(first), 0.0, line.axial(first)}, edges_.over_second().inner());
    return angle_of({first, second});
}

std::optional<std::array<double, 2>> LevelCurve::angles_at(std::size_t edge,
                                                           double z) const noexcept {
    if (edge == 1) {
        if (z <= lower_ || z >= upper_) {
            return std::nullopt;
        }
        const double sine = (z - middle_) / half_width_;
        const double angle = math::atan2(sine, std::sqrt((1.0 - sine) * (1.0 + sine)));
        return std::array{math::kPi - angle, angle};
    }
    const LineAbout& line = edges_.first_about_second();
    const auto places = places_of_length({line.radius(z), 0.0, line.axial(z)},
                                         edges_.over_second().inner(),
                                         length_ - edges_.over_second().after(z));
    if (!places) {
        return std::nullopt;
    }
    return std::array{angle_of({z, places->min}), angle_of({z, places->max})};
}

// What lies beyond an end of an edge is one piece of the curve, about its extreme point.
std::vector<Interval> LevelCurve::parts_on_edges() const {
    constexpr double kHalfTurn = math::kPi;
    std::vector<Interval> cuts;
    if (const auto angles = angles_at(0, edges_.part(0).max)) {  // about t = 0
        const auto [from, to] = *angles;
        cuts.push_back({from > 0.5 * kHalfTurn ? from - kTurn : from, to});
    }
    if (const auto angles = angles_at(0, edges_.part(0).min)) {  // about t = pi
        const auto [to, from] = *angles;
        cuts.push_back({from, to < 0.5 * kHalfTurn ? to + kTurn : to});
    }
    if (const auto angles = angles_at(1, edges_.part(1).max)) {  // about t = pi / 2
        cuts.push_back({(*angles)[1], (*angles)[0]});
    }
    if (const auto angles = angles_at(1, edges_.part(1).min)) {  // about t = 3 pi / 2
        cuts.push_back({(*angles)[0], kTurn + (*angles)[1]});
    }
    // What is left of [0, 2 pi].
    std::vector<Interval> within;
    for (const Interval& cut : cuts) {
        for (const double shift : {-kTurn, 0.0, kTurn}) {
            const Interval moved{std::max(0.0, cut.min + shift), std::min(kTurn, cut.max + shift)};
            if (moved.min < moved.max) {
                within.push_back(moved);
            }
        }
    }
    std::sort(within.begin(), within.end(), [](const Interval& a, const Interval& b) {
        return a.min < b.min;
    });
    std::vector<Interval> left;
    double from = 0.0;
    for (const Interval& cut : within) {
        if (cut.min > from) {
            left.push_back({from, cut.min});
        }
        from = std::max(from, cut.max);
    }
    if (from < kTurn) {
        left.push_back({from, kTurn});
    }
    return left;
}

}  // namespace earshot::propagation
