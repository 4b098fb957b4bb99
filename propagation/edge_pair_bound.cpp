// SPDX-License-Identifier: MIT
#include "earshot/base/math.h"
#include "earshot/propagation/internal/edge_pair_geometry.h"
#include "earshot/propagation/internal/wedge_terms.h"
#include "earshot/propagation/second_order_diffraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

namespace earshot::propagation {

using geometry::Interval;
using geometry::WedgePoint;

namespace {

constexpr double kTurn = 2.0 * math::kPi;
constexpr double kMaxExpEta = 1e100;  // where the terms are nothing

using KindFactors = std::array<Interval, 3>;

/// Bounds on the absolute values of the terms nu sin a / (cosh(nu eta) - cos a) of a wedge, times
/// their factors, for all directions between two and all eta of an interval.
struct TermBounds {
    double sum = 0.0;              ///< of the sum of all
    double largest = 0.0;          ///< of one term
    double sum_of_rest = 0.0;      ///< of the sum of all but the largest
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

/// e^{asinh x}.
double exp_asinh(double x) noexcept {
    const double root = std::sqrt(x * x + 1.0);
    return x < 0.0 ? 1.0 / (root - x) : root + x;
}

/// Metres along an axis per metre away from it, on the ways from the points of a part of a line to
/// a place on the axis. Nothing where the line comes so close that rounding tells.
std::optional<Interval> slopes_to(double z, const LineAbout& line, const Interval& part) noexcept {
    // n / r, where n and r^2 are a linear and a quadratic function, has one extreme place.
    const double rise = z - line.axial(0.0), along = -line.axial_slope();
    const double product = line.radius_slope_product(0.0);
    const double radius = line.radius(0.0), radius_slope = line.radius_slope();
    const double extreme = (along * radius * radius - rise * product) /
                           (rise * radius_slope * radius_slope - along * product);
    const bool is_within = extreme > part.min && extreme < part.max;
    constexpr double kMinRadius = 1e-6;
    Interval slopes{std::numeric_limits<double>::infinity(),
                    -std::numeric_limits<double>::infinity()};
    for (const double place : {part.min, part.max, is_within ? extreme : part.min}) {
        const double to_line = line.radius(place);
        const double to_place = z - line.axial(place);
        if (!(to_line > kMinRadius * (std::abs(to_place) + 1.0))) {
            return std::nullopt;
        }
        slopes = {std::min(slopes.min, to_place / to_line),
                  std::max(slopes.max, to_place / to_line)};
    }
    return slopes;
}

/// Bounds on e^{|eta|} of all ways from an end over a part of the axis to a part of a line. `end`:
/// about the axis.
Interval exp_eta(const WedgePoint& end,
                 const Interval& part,
                 const LineAbout& line,
                 const Interval& line_part) noexcept {
    // Either slope rises along the axis.
    const std::optional<Interval> at_begin = slopes_to(part.min, line, line_part);
    const std::optional<Interval> at_end = slopes_to(part.max, line, line_part);
    if (!at_begin || !at_end) {
        return {1.0, kMaxExpEta};
    }
    constexpr double kRoundedDown = 1.0 - 1e-6;
    const double least = exp_asinh((part.min - end.z) / end.radius) * exp_asinh(at_begin->min);
    const double most = exp_asinh((part.max - end.z) / end.radius) * exp_asinh(at_end->max);
    return {std::max({1.0, least * kRoundedDown, kRoundedDown / most}),
            std::max(most, 1.0 / least) / kRoundedDown};
}

/// Of nu |eta| / 2 at the smallest and at the largest |eta|.
struct Hyperbolics {
    std::array<double, 2> tanh{}, sech_squared{};

    Hyperbolics(double nu, const Interval& exp_eta) noexcept {
        const std::array<double, 2> ends{exp_eta.min, exp_eta.max};
        for (std::size_t i = 0; i < 2; ++i) {
            const double exp_eta_end = std::min(kMaxExpEta, ends[i]);
            const double root = math::exp(nu * math::log(exp_eta_end));
            tanh[i] = (root - 1.0) / (root + 1.0);
            sech_squared[i] = 4.0 * root / ((root + 1.0) * (root + 1.0));
        }
    }

    /// sin a / (cosh(nu eta) - cos a), with t = tan(|a| / 2).
    double term(double t, std::size_t end) const noexcept {
        return t * sech_squared[end] / (tanh[end] * tanh[end] + t * t);
    }
};

/// All values of a term sin a / (cosh(nu eta) - cos a), where a takes the values of an interval, in
/// whole turns.
struct TermRange {
    Interval values{};
    double largest = 0.0;  ///< absolute value
    double area = 0.0;     ///< at least the integral of nu |term| over all eta

    TermRange(const Interval& turns, const Hyperbolics& eta) noexcept {
        // The ends of the interval of |a|.
        const double low = turns.min - std::nearbyint(turns.min);
        const double high = turns.max - std::nearbyint(turns.max);
        const bool has_boundary = std::floor(turns.max) >= std::ceil(turns.min);
        const bool has_half_turn = std::floor(turns.max + 0.5) >= std::ceil(turns.min + 0.5);
        const double closest = has_boundary ? 0.0 : std::min(std::abs(low), std::abs(high));
        const double farthest = has_half_turn ? 0.5 : std::max(std::abs(low), std::abs(high));
        const double angle = std::max(kTurn * closest, kMinTermAngle);
        const double t_min = tan_of_half(angle);
        const double t_max = tan_of_half(std::max(kTurn * farthest, kMinTermAngle));
        // A term is t (1 - h^2) / (h^2 + t^2), h = tanh(nu eta / 2), which falls with h, and is
        // largest at t = h.
        constexpr double kRoundedUp = 1.0 + 1e-9;
        largest = kRoundedUp * eta.term(std::clamp(eta.tanh[0], t_min, t_max), 0);
        const double smallest = std::min(eta.term(t_min, 1), eta.term(t_max, 1)) / kRoundedUp;
        area = 2.0 * (math::kPi - angle + kMinTermAngle);
        // Closer to where it changes rounding may tell the sign.
        constexpr double kFarthest = 0.5 - kMinTermAngle;
        const bool has_sign =
            !has_boundary && !has_half_turn && angle > 2.0 * kMinTermAngle && farthest < kFarthest;
        if (!has_sign) {
            values = {-largest, largest};
        } else if (low > 0.0) {
            values = {smallest, largest};
        } else {
            values = {-largest, -smallest};
        }
    }

private:
    static double tan_of_half(double angle) noexcept {
        constexpr double kMinCosine = 1e-9;
        return math::sin(0.5 * angle) / std::max(math::cos(0.5 * angle), kMinCosine);
    }
};

/// All products of two intervals, the first of which has no negative values.
Interval products(const Interval& factor, const Interval& values) noexcept {
    return {std::min(factor.min * values.min, factor.max * values.min),
            std::max(factor.min * values.max, factor.max * values.max)};
}

double largest_of(const Interval& values) noexcept {
    return std::max(-values.min, values.max);
}

TermBounds term_bounds(double open_angle,
                       double fixed_angle,
                       const Interval& angles,
                       const Interval& exp_eta,
                       const KindFactors& factors) noexcept {
    const double nu = math::kPi / open_angle;
    const Hyperbolics eta(nu, exp_eta);
    Interval sum{0.0, 0.0}, of_largest{0.0, 0.0};
    TermBounds bounds;
    for (const double of_fixed : {1.0, -1.0}) {
        for (const double of_other : {1.0, -1.0}) {
            const auto turns = [&](double angle) {
                return (math::kPi + of_fixed * fixed_angle + of_other * angle) / (2.0 * open_angle);
            };
            const TermRange term({turns(of_other > 0.0 ? angles.min : angles.max),
                                  turns(of_other > 0.0 ? angles.max : angles.min)},
                                 eta);
            const std::size_t kind = of_fixed != of_other ? 0 : of_fixed < 0.0 ? 1 : 2;
            const Interval values = products(factors[kind], term.values);
            sum = {sum.min + values.min, sum.max + values.max};
            const double area = factors[kind].max * term.area;
            if (nu * factors[kind].max * term.largest > bounds.largest) {
                bounds.largest = nu * factors[kind].max * term.largest;
                bounds.area_of_largest = area;
                of_largest = values;
            }
            bounds.area += area;
        }
    }
    bounds.sum = nu * largest_of(sum);
    bounds.sum_of_rest = nu * largest_of({sum.min - of_largest.min, sum.max - of_largest.max});
    return bounds;
}

/// Metres from a point to the closest of a part of an axis.
double distance(const WedgePoint& point, const Interval& part) noexcept {
    return diagonal(point.radius, point.z - std::clamp(point.z, part.min, part.max));
}

/// The bound for parts of two edges.
class PairBound {
public:
    PairBound(const DoubleDiffraction& edges, const TermFactors& factors) noexcept
        : pair_(edges),
          factors_(factors),
          open_angles_{edges.first.open_angle, edges.second.open_angle},
          about_other_{geometry::wedge_coordinates(edges.second, edges.source),
                       geometry::wedge_coordinates(edges.first, edges.listener)},
          half_(edges.common_face ? 0.5 : 1.0) {}

    std::array<Interval, 2> parts() const noexcept { return {pair_.part(0), pair_.part(1)}; }
    double of(const std::array<Interval, 2>& parts) const noexcept;

private:
    EdgePairGeometry pair_;
    TermFactors factors_;
    std::array<double, 2> open_angles_{};
    std::array<WedgePoint, 2> about_other_{};  // source and listener about the edge farther away
    double half_ = 1.0;
};

// With
//   |H2| <= f / (16 pi^2) int int |nu B1| |nu B2| / (m M l) dz1 dz2,
// the integral over one edge, of |nu B| dz / (m M), is at most the length of the part times the
// largest value of the sum of terms over the smallest distances, and since dz / (m M) =
// d eta / (m + M), at most the integral of the terms over all eta divided by the smallest m + M;
// terms that are close to their zone boundary need the latter. What remains, |nu B| dz / l over the
// other edge, is bounded by the largest value of the sum. Either edge may be the first of both; the
// smaller bound holds.
double PairBound::of(const std::array<Interval, 2>& parts) const noexcept {
    constexpr double kRoundedDown = 1.0 - 1e-9;
    const double link = kRoundedDown * pair_.link(pair_.closest_points(parts));
    const std::array<const WedgePoint*, 2> own{&pair_.source(), &pair_.listener()};
    const std::array<const LineAbout*, 2> others{&pair_.second_about_first(),
                                                 &pair_.first_about_second()};
    std::array<double, 2> inner{}, outer{};
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const Interval& other_part = parts[1 - edge];
        const double open_angle = open_angles_[edge];
        const TermBounds bounds =
            term_bounds(open_angle,
                        own[edge]->angle,
                        angles_of(*others[edge], other_part, open_angle),
                        exp_eta(*own[edge], parts[edge], *others[edge], other_part),
                        factors_[edge]);
        const double length = parts[edge].max - parts[edge].min;
        const double to_end = kRoundedDown * distance(*own[edge], parts[edge]);
        const double way =
            std::max(to_end + link, kRoundedDown * distance(about_other_[edge], other_part));
        outer[edge] = length * bounds.sum / to_end;
        inner[edge] = bounds.area / way;
        if (link > 0.0) {
            const double spread = length / (to_end * link);
            inner[edge] = std::min({inner[edge],
                                    spread * bounds.sum,
                                    bounds.area_of_largest / way + spread * bounds.sum_of_rest});
        }
    }
    constexpr double kRoundedUp = 1.0 + 1e-6;
    return kRoundedUp * half_ / (16.0 * math::kPi * math::kPi) *
           std::min(inner[0] * outer[1], inner[1] * outer[0]);
}

/// Parts of two edges, and the bound for them.
struct Cell {
    const PairBound* pair = nullptr;
    std::array<Interval, 2> parts{};
    double bound = 0.0;

    friend bool operator<(const Cell& a, const Cell& b) noexcept { return a.bound < b.bound; }
};

/// The two halves of a cell across one of the edges.
std::array<Cell, 2> halves(const Cell& cell, std::size_t edge) noexcept {
    std::array<Cell, 2> halves{cell, cell};
    const double middle = 0.5 * (cell.parts[edge].min + cell.parts[edge].max);
    halves[0].parts[edge].max = middle;
    halves[1].parts[edge].min = middle;
    for (Cell& half : halves) {
        half.bound = std::min(cell.bound, cell.pair->of(half.parts));
    }
    return halves;
}

}  // namespace

double max_doubly_diffracted_pressure(const DoubleDiffraction& edges) noexcept {
    const PairBound bound(edges, kAnyTermFactors);
    return bound.of(bound.parts());
}

// The bound of a cell falls faster than its size: the terms are far from zone boundaries in most of
// a pair, and what is far from both ends counts less. So the largest cell is halved, across the
// edge that leaves less.
double max_doubly_diffracted_pressure(std::span<const DoubleDiffraction> ways,
                                      double enough,
                                      int max_halvings,
                                      std::span<const TermFactors> factors) {
    std::vector<PairBound> pairs;
    std::vector<Cell> cells;
    pairs.reserve(ways.size() * factors.size());
    double sum = 0.0;
    for (const DoubleDiffraction& way : ways) {
        for (const TermFactors& choice : factors) {
            const PairBound& pair = pairs.emplace_back(way, choice);
            cells.push_back({&pair, pair.parts(), pair.of(pair.parts())});
            sum += cells.back().bound;
        }
    }
    std::make_heap(cells.begin(), cells.end());
    for (int halved = 0; halved < max_halvings && !(sum < enough); ++halved) {
        std::pop_heap(cells.begin(), cells.end());
        const std::array options{halves(cells.back(), 0), halves(cells.back(), 1)};
        const auto total = [](const std::array<Cell, 2>& of) { return of[0].bound + of[1].bound; };
        const auto& best = total(options[0]) < total(options[1]) ? options[0] : options[1];
        cells.back() = best[0];
        std::push_heap(cells.begin(), cells.end());
        cells.push_back(best[1]);
        std::push_heap(cells.begin(), cells.end());
        sum = std::accumulate(cells.begin(), cells.end(), 0.0, [](double so_far, const Cell& cell) {
            return so_far + cell.bound;
        });
    }
    return sum;
}

}  // namespace earshot::propagation
