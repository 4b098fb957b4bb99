// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"

#include <array>
#include <optional>
#include <string>

namespace earshot::collision {

/// A fraction of integers in decimal digits: the numerator may begin with a minus sign, the
/// denominator is positive.
struct Rational {
    std::string numerator = "0";
    std::string denominator = "1";
};

/// Four moving points with any rational coordinates.
struct RationalPoints {
    std::array<std::array<Rational, 3>, 4> begin{}, end{};
};

/// The same points, if every coordinate is a double.
std::optional<MovingPoints> as_doubles(const RationalPoints& points);

/// As the functions of moving_points.h, in exact arithmetic throughout.
std::optional<double> vertex_face_ccd(const RationalPoints& points);
std::optional<double> edge_edge_ccd(const RationalPoints& points);

}  // namespace earshot::collision
