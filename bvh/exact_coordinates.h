// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cmath>
#include <cstdint>

namespace earshot::bvh {

/// How the coordinates of a mesh follow from their roundings to single precision, if they do. From
/// files they often do: coordinates are single-precision numbers (binary formats), or decimal
/// numbers of few digits (text formats), that is the doubles nearest to k / 10^n for whole numbers
/// k. Then packed leaves hold the vertices exactly, and a hit is decided without reading the mesh.
class ExactCoordinates {
public:
    /// They do not follow.
    ExactCoordinates() = default;

    /// Coordinates are single-precision numbers.
    static ExactCoordinates single() noexcept { return ExactCoordinates(Rule::single, 1.0); }
    /// Coordinates are multiples of 1 / `scale`, which is not 1.
    static ExactCoordinates decimal(double scale) noexcept {
        return ExactCoordinates(Rule::decimal, scale);
    }

    bool are_known() const noexcept { return rule_ != Rule::none; }
    friend bool operator==(const ExactCoordinates&, const ExactCoordinates&) = default;

    /// The coordinate that rounds to a number. Precondition: are_known().
    double restore(float rounded) const noexcept {
        const auto coordinate = static_cast<double>(rounded);
        if (rule_ == Rule::single) {
            return coordinate;
        }
        // A quotient is the double nearest to the decimal number, as a reader of text finds it.
        const double steps = (coordinate * scale_ + kRound) - kRound;
        return std::copysign(steps / scale_, coordinate);
    }
    /// Of decimal numbers; 1 of single-precision ones.
    double scale() const noexcept { return scale_; }

    /// Adding and subtracting it rounds to the nearest whole number.
    static constexpr double kRound = 0x1.8p52;

private:
    enum class Rule : std::uint8_t { none, single, decimal };

    ExactCoordinates(Rule rule, double scale) noexcept : rule_(rule), scale_(scale) {}

    Rule rule_ = Rule::none;
    double scale_ = 1.0;
};

}  // namespace earshot::bvh
