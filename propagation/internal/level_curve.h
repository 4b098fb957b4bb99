// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/interval.h"
#include "earshot/propagation/internal/edge_pair_geometry.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace earshot::propagation {

/// The pairs of points of two edges over which the way from source to listener has one length. They
/// form a closed convex curve about the shortest way, of which parts lie outside the edges. It is
/// run through by an angle t, in which it is smooth: the place on the second edge is
/// middle + half_width sin t, that on the first the larger of both that have the length where
/// cos t > 0, and the smaller where cos t < 0.
class LevelCurve {
public:
    /// Precondition: no way is longer than `length` but for rounding, and some is shorter.
    LevelCurve(const EdgePairGeometry& edges, double length) noexcept;

    /// A point of the curve.
    struct Point {
        std::array<double, 2> z{};  ///< on either edge
        double first_root = 0.0;    ///< e^{|eta| / 2} at the first edge
        /// d z2 / (l rs r sinh eta), what the double integral has for each dt and metre of length
        double measure = 0.0;
    };
    Point at(double t) const noexcept;

    /// The angle of the point with the largest place on the first edge (`side` +1), or the smallest
    /// (-1): there the second wedge's terms have their peak.
    double extreme_of_first(double side) const noexcept;
    /// The place on the second edge where it is largest (+1) or smallest (-1), at t = +- pi / 2:
    /// there the first wedge's terms have their peak.
    double turn(double side) const noexcept { return side > 0.0 ? upper_ : lower_; }
    double half_width() const noexcept { return half_width_; }

    /// The angles of the points with a place on an edge, 0 or 1: that with the smaller place on the
    /// other edge first. Nothing if the curve does not come so far.
    std::optional<std::array<double, 2>> angles_at(std::size_t edge, double z) const noexcept;

    /// The intervals of t that lie on the edges, within [0, 2 pi].
    std::vector<geometry::Interval> parts_on_edges() const;

    /// The angle of a point of the curve; of others that of one close by, if one is.
    double angle_of(const std::array<double, 2>& z) const noexcept;

private:
    const EdgePairGeometry& edges_;
    double length_;
    double lower_ = 0.0, upper_ = 0.0;  // of the places on the second edge
    double middle_ = 0.0, half_width_ = 0.0;
};

}  // namespace earshot::propagation
