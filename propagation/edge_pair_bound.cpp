// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"
#include "earshot/propagation/internal/edge_pair_geometry.h"
#include "earshot/propagation/internal/wedge_terms.h"
#include "earshot/propagation/second_order_diffraction.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::propagation {

using geometry::Interval;
using geometry::WedgePoint;

namespace {

constexpr double kTurn = 2.0 * math::kPi;

/// Bounds on the terms nu sin a / (cosh(nu eta) - cos a) of a wedge for all directions between two.
struct TermBounds {
    double sum = 0.0;              ///< of the terms of one sign, at the apex
    double largest = 0.0;          ///< of one term
    double sum_of_rest = 0.0;      ///< of the terms of one sign but the largest
    double area_of_largest = 0.0;  ///< integral of the largest term over all eta
    double area = 0.0;             ///< and of all terms together
};

/// The angles of the points of a part of a line about an axis, between those of its ends: within a
/// sector of the air.
Interval angles_of(const LineAbout& line, const Interval& part, double open_angle) noexcept {
    if (line.has_fixed_angle()) {
        return {line.angle(part.min), line.angle(part.min)};
    }
    constexpr double kSlack = 1e-9;
    const double min_radius = kSlack * (part.max - part.min);
    double from = line.angle(part.min), to = line.angle(part.max);
    // A point of the axis has any angle; that of the others is constant then.
    from = line.radius(part.min) > min_radius ? from : to;
    to = line.radius(part.max) > min_radius ? to : from;
    // Seen from the axis a part of a line turns by less than half a turn.
    const double by = to - from - kTurn * std::nearbyint((to - from) / kTurn);
    Interval within{open_angle, 0.0};
    for (const double shift : {-kTurn, 0.0, kTurn}) {
        const double low = std::max(0.0, from + std::min(by, 0.0) + shift - kSlack);
        const double high = std::min(open_angle, from + std::max(by, 0.0) + shift + kSlack);
        if (low <= high) {
            within = {std::min(within.min, low), std::max(within.max, high)};
        }
    }
    return within.min <= within.max ? within : Interval{0.0, open_angle};
}

TermBounds term_bounds(double open_angle, double fixed_angle, const Interval& angles) noexcept {
    const double nu = math::kPi / open_angle;
    std::array<double, 2> of_sign{};
    std::array<bool, 2> has_largest{};
    TermBounds bounds;
    for (const double of_fixed : {1.0, -1.0}) {
        for (const double of_other : {1.0, -1.0}) {
            const auto turns = [&](double angle) {
                return (math::kPi + of_fixed * fixed_angle + of_other * angle) / (2.0 * open_angle);
            };
            const double low = turns(of_other > 0.0 ? angles.min : angles.max);
            const double high = turns(of_other > 0.0 ? angles.max : angles.min);
            // The smallest |a|, a being 2 pi times the distance from a whole number.
            const double closest = std::floor(high) >= std::ceil(low)
                                       ? 0.0
                                       : std::min(low - std::floor(low), std::ceil(high) - high);
            const double angle = std::max(kTurn * closest, kMinTermAngle);
            // cot x <= 1 / x - x / 3 up to pi / 2.
            const double term = nu * std::max(0.0, 2.0 / angle - angle / 6.0);
            const double area = 2.0 * (math::kPi - angle + kMinTermAngle);
            const bool is_one_signed = std::floor(2.0 * low) == std::floor(2.0 * high);
            const bool is_positive = std::fmod(std::floor(2.0 * low), 2.0) == 0.0;
            const std::array<bool, 2> has_sign{!is_one_signed || is_positive,
                                               !is_one_signed || !is_positive};
            for (std::size_t i = 0; i < 2; ++i) {
                of_sign[i] += has_sign[i] ? term : 0.0;
            }
            if (term > bounds.largest) {
                bounds.largest = term;
                bounds.area_of_largest = area;
                has_largest = has_sign;
            }
            bounds.area += area;
        }
    }
    bounds.sum = std::max(of_sign[0], of_sign[1]);
    bounds.sum_of_rest = std::max(of_sign[0] - (has_largest[0] ? bounds.largest : 0.0),
                                  of_sign[1] - (has_largest[1] ? bounds.largest : 0.0));
    return bounds;
}

/// Metres from a point to the closest of a part of an axis.
double distance(const WedgePoint& point, const Interval& part) noexcept {
    return diagonal(point.radius, point.z - std::clamp(point.z, part.min, part.max));
}

}  // namespace

// The absolute value of a sum of terms of either sign is at most the larger of both sums. With
//   |H2| <= f / (16 pi^2) int int |nu B1| |nu B2| / (m M l) dz1 dz2,
// the integral over one edge, of |nu B| dz / (m M), is at most the length of the part times the
// terms at the apex over the smallest distances, and since dz / (m M) = d eta / (m + M), at most
// the integral of the terms over all eta divided by the smallest m + M; terms that are close to
// their zone boundary need the latter. What remains, |nu B| dz / l over the other edge, is bounded
// by the terms at the apex. Either edge may be the first of both; the smaller bound holds.
double max_doubly_diffracted_pressure(const DoubleDiffraction& edges) noexcept {
    const EdgePairGeometry pair(edges);
    constexpr double kRoundedDown = 1.0 - 1e-9;
    const double link = kRoundedDown * pair.link(pair.closest_points());
    const std::array<geometry::Vec3, 2> ends{edges.source, edges.listener};
    const std::array<const geometry::Wedge*, 2> wedges{&edges.first, &edges.second};
    const std::array<WedgePoint, 2> own{pair.source(), pair.listener()};
    const std::array<const LineAbout*, 2> others{&pair.second_about_first(),
                                                 &pair.first_about_second()};
    std::array<double, 2> inner{}, outer{};
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const Interval& part = pair.part(edge);
        const Interval& other_part = pair.part(1 - edge);
        const double open_angle = wedges[edge]->open_angle;
        const TermBounds bounds = term_bounds(
            open_angle, own[edge].angle, angles_of(*others[edge], other_part, open_angle));
        const double length = part.max - part.min;
        const double to_end = kRoundedDown * distance(own[edge], part);
        const double way = std::max(
            to_end + link,
            kRoundedDown *
                distance(geometry::wedge_coordinates(*wedges[1 - edge], ends[edge]), other_part));
        outer[edge] = length * bounds.sum / to_end;
        inner[edge] = bounds.area / way;
        if (link > 0.0) {
            const double spread = length / (to_end * link);
            inner[edge] = std::min({inner[edge],
                                    spread * bounds.sum,
                                    bounds.area_of_largest / way + spread * bounds.sum_of_rest});
        }
    }
    const double half = edges.common_face ? 0.5 : 1.0;
    constexpr double kRoundedUp = 1.0 + 1e-6;
    return kRoundedUp * half / (16.0 * math::kPi * math::kPi) *
           std::min(inner[0] * outer[1], inner[1] * outer[0]);
}

}  // namespace earshot::propagation
