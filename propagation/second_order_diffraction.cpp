// SPDX-License-Identifier: MIT
#include "earshot/propagation/second_order_diffraction.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/interval.h"
#include "earshot/propagation/internal/complex_math.h"
#include "earshot/propagation/internal/edge_terms.h"
#include "earshot/propagation/internal/graded_quadrature.h"
#include "earshot/propagation/uniform_diffraction.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::propagation {
namespace {

using geometry::Vec3;
using geometry::Wedge;
using geometry::WedgePoint;

/// Radians: where a zone boundary is closer, the integrand is taken as if it were this far. A term
/// then differs by less than 1e-6 of itself from its limit, half the step of the sound it mends.
constexpr double kMinTermAngle = 1e-6;

/// Of the length of a part of an edge: distances of singularities below it are not resolved
/// further. Where edges meet, the integrand grows only as the inverse of the distance between the
/// points.
constexpr double kMinScale = 1e-5;

/// The sum over the terms of sin a / (cosh(nu eta) - cos a), of one wedge and a pair of directions.
class WedgeTerms {
public:
    WedgeTerms(double open_angle, double source_angle, double listener_angle) noexcept
        : nu_(math::kPi / open_angle) {
        const auto terms =
            edge_terms(open_angle, source_angle, listener_angle, {1.0, 1.0, 1.0}, {});
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const double half_sine = std::max(terms[i].half_sine, 0.5 * kMinTermAngle);
            sine_[i] = terms[i].sign * 2.0 * half_sine * terms[i].half_cosine;
            offset_[i] = 2.0 * half_sine * half_sine;
            min_angle_ = std::min(min_angle_, std::max(terms[i].angle, kMinTermAngle));
        }
    }

    /// In the order of edge_terms(). `power` is e^eta.
    std::array<double, 4> values(double power) const noexcept {
        const double root =
            nu_ == 0.5 ? std::sqrt(std::sqrt(power)) : math::exp(0.5 * nu_ * math::log(power));
        const double twice_sinh = root - 1.0 / root;
        const double rise = 0.5 * twice_sinh * twice_sinh;
        std::array<double, 4> values{};
        for (std::size_t i = 0; i < sine_.size(); ++i) {
            values[i] = sine_[i] / (rise + offset_[i]);
        }
        return values;
    }

    double nu() const noexcept { return nu_; }
    /// |eta| of the pole that is closest to the apex.
    double pole() const noexcept { return min_angle_ / nu_; }

private:
    double nu_;
    std::array<double, 4> sine_{}, offset_{};
    double min_angle_ = math::kPi;
};

/// One number for each term at the first edge and each at the second.
class TermProducts {
public:
    void add_absolute(double factor,
                      const std::array<double, 4>& first,
                      const std::array<double, 4>& second) noexcept {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                sums_[4 * i + j] += factor * std::abs(first[i] * second[j]);
            }
        }
    }
    void add(const Complex& factor,
             const std::array<double, 4>& first,
             const std::array<double, 4>& second) noexcept {
        for (std::size_t i = 0; i < 4; ++i) {
            const Complex weighted = first[i] * factor;
            for (std::size_t j = 0; j < 4; ++j) {
                sums_[4 * i + j] += second[j] * weighted;
            }
        }
    }
    void add(const Complex& factor, const TermProducts& other) noexcept {
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            sums_[i] += factor * other.sums_[i];
        }
    }
    const Complex& at(std::size_t first, std::size_t second) const noexcept {
        return sums_[4 * first + second];
    }

private:
    std::array<Complex, 16> sums_{};
};

/// The weight of a way by its share of the maximum phase. Up to one half all ways count; from
/// there on it falls smoothly, so that no end of an edge is made up.
double weight_of_phase(double share) noexcept {
    const double x = 2.0 * share - 1.0;
    if (x <= 0.0) {
        return 1.0;
    }
    // Three derivatives vanish at both ends.
    return x >= 1.0 ? 0.0 : 1.0 - x * x * x * x * (35.0 - x * (84.0 - x * (70.0 - x * 20.0)));
}

/// The part of an interval about `lowest` in which a convex function is below a limit.
template <typename Function>
geometry::Interval below(
    double limit, double begin, double end, double lowest, const Function& function) noexcept {
    constexpr int kHalvings = 24;
    const auto edge = [&](double far) {
        if (function(far) <= limit) {
            return far;
        }
        double inside = lowest;
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = 0.5 * (inside + far);
            (function(middle) <= limit ? inside : far) = middle;
        }
        return far;
    };
    return {edge(begin), edge(end)};
}

/// x + sqrt(1 + x^2) = e^{asinh x}.
double exponential_of_asinh(double x) noexcept {
    const double sum = std::abs(x) + std::sqrt(1.0 + x * x);
    return x < 0.0 ? 1.0 / sum : sum;
}

/// e^eta of a point of an edge between a point before it and one after it.
double exponential_of_eta(double z, const WedgePoint& before, const WedgePoint& after) noexcept {
    return exponential_of_asinh((z - before.z) / before.radius) *
           exponential_of_asinh((z - after.z) / after.radius);
}

double apex_z(const WedgePoint& before, const WedgePoint& after) noexcept {
    return (before.z * after.radius + after.z * before.radius) / (before.radius + after.radius);
}

double distance_at(const WedgePoint& point, double z) noexcept {
    return std::sqrt(point.radius * point.radius + (z - point.z) * (z - point.z));
}

/// How far along the edge, beside the apex, the integrand is far from its peak there.
double peak_width(const WedgePoint& before, const WedgePoint& after, double pole) noexcept {
    const double z = apex_z(before, after);
    const double m = distance_at(before, z);
    const double l = distance_at(after, z);
    return pole * m * l / (m + l);
}

/// Where a function that rises or falls throughout is 0; where it is not, the end with the smaller
/// value.
template <typename Function>
double find_root(double low, double high, const Function& function) noexcept {
    const double at_low = function(low);
    const double at_high = function(high);
    if ((at_low > 0.0) == (at_high > 0.0)) {
        return std::abs(at_low) < std::abs(at_high) ? low : high;
    }
    constexpr int kHalvings = 40;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        ((function(middle) > 0.0) == (at_low > 0.0) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

class DoubleIntegral {
public:
    DoubleIntegral(const DoubleDiffraction& edges, double wave_number, double max_phase) noexcept
        : edges_(edges),
          k_(wave_number),
          max_detour_(max_phase / wave_number),
          source_(geometry::wedge_coordinates(edges.first, edges.source)),
          listener_(geometry::wedge_coordinates(edges.second, edges.listener)),
          path_(shortest_path(edges)) {}

    DoublyDiffractedPressure value() const noexcept;
    /// Of the absolute values of all terms, at the wave number 0.
    double bound() const noexcept;

private:
    TermProducts integral() const noexcept;
    double factor() const noexcept {
        const double half = edges_.common_face ? 0.5 : 1.0;
        return half / (16.0 * edges_.first.open_angle * edges_.second.open_angle);
    }
    WedgePoint seen_from_first(double second_z) const noexcept {
        WedgePoint point =
            geometry::wedge_coordinates(edges_.first, edges_.second.point_at(second_z));
        if (edges_.common_face) {
            point.angle = edges_.common_face->of_first == 0 ? 0.0 : edges_.first.open_angle;
        }
        return point;
    }
    WedgePoint seen_from_second(double first_z) const noexcept {
        WedgePoint point =
            geometry::wedge_coordinates(edges_.second, edges_.first.point_at(first_z));
        if (edges_.common_face) {
            point.angle = edges_.common_face->of_second == 0 ? 0.0 : edges_.second.open_angle;
        }
        return point;
    }
    WedgeTerms terms_at_first(const WedgePoint& second) const noexcept {
        return {edges_.first.open_angle, source_.angle, second.angle};
    }
    WedgeTerms terms_at_second(const WedgePoint& first) const noexcept {
        return {edges_.second.open_angle, first.angle, listener_.angle};
    }
    double link(double first_z, double second_z) const noexcept {
        return glm::distance(edges_.first.point_at(first_z), edges_.second.point_at(second_z));
    }
    double peak_at_first(double second_z) const noexcept;
    double place_of_peak(double first_z) const noexcept;
    TermProducts inner(double second_z) const noexcept;

    const DoubleDiffraction& edges_;
    double k_;
    double max_detour_;    // metres; infinite at the wave number 0
    WedgePoint source_;    // about the first edge
    WedgePoint listener_;  // about the second
    DoublePath path_;
};

// The z of the first edge from which the shortest way to the listener passes the second edge in
// `second_z`: there the second wedge's integrand has its peak. An end of the part if there is none.
double DoubleIntegral::peak_at_first(double second_z) const noexcept {
    const auto position = [&](double first_z) {
        return math::log(exponential_of_eta(second_z, seen_from_second(first_z), listener_));
    };
    return find_root(edges_.first_begin, edges_.first_end, position);
}

// The z of the second edge from which the first wedge's integrand has its peak at `first_z`; an end
// of the part if there is none.
double DoubleIntegral::place_of_peak(double first_z) const noexcept {
    const auto position = [&](double second_z) {
        return apex_z(source_, seen_from_first(second_z)) - first_z;
    };
    return find_root(edges_.second_begin, edges_.second_end, position);
}

// The integral over the first edge for a point of the second one.
TermProducts DoubleIntegral::inner(double second_z) const noexcept {
    const WedgePoint second = seen_from_first(second_z);
    const WedgeTerms first_terms = terms_at_first(second);
    const WedgeTerms some_second_terms = terms_at_second(seen_from_second(path_.first_z));
    const double min_scale = kMinScale * (edges_.first_end - edges_.first_begin);

    // Where the integrand is steep: abreast of the source and of the point, and at both peaks.
    std::array<SteepPlace, 4> steep{
        SteepPlace{source_.z, source_.radius},
        SteepPlace{second.z, std::max(second.radius, min_scale)},
        SteepPlace{apex_z(source_, second), peak_width(source_, second, first_terms.pole())},
        SteepPlace{source_.z, source_.radius}};
    if (some_second_terms.pole() < 0.5) {
        const double z = peak_at_first(second_z);
        // The peak moves along the first edge by the link's share of the way.
        const WedgePoint first = seen_from_second(z);
        const double reach = some_second_terms.pole() * std::max(first.radius, min_scale);
        steep[3] = {z, reach};
    }
    const bool is_fixed = edges_.common_face.has_value();
    const double beyond =
        distance_at(listener_, second_z) - path_.before - path_.between - path_.after;
    const auto detour = [&](double z) {
        return distance_at(source_, z) + distance_at(second, z) + beyond;
    };
    const geometry::Interval part =
        below(max_detour_,
              edges_.first_begin,
              edges_.first_end,
              std::clamp(apex_z(source_, second), edges_.first_begin, edges_.first_end),
              detour);
    TermProducts sum;
    integrate_graded(
        part.min,
        part.max,
        steep,
        [&](double z) { return k_ * (distance_at(source_, z) + distance_at(second, z)); },
        [&](double z, double weight) {
            const WedgePoint first = seen_from_second(z);
            const double m = distance_at(source_, z);
            const double between = distance_at(second, z);
            const double power = exponential_of_eta(second_z, first, listener_);
            weight *= weight_of_phase((m + between + beyond) / max_detour_) / (m * between);
            const auto at_first = first_terms.values(exponential_of_eta(z, source_, second));
            const auto at_second =
                is_fixed ? some_second_terms.values(power) : terms_at_second(first).values(power);
            if (k_ == 0.0) {
                sum.add_absolute(weight, at_first, at_second);
                return;
            }
            sum.add(weight * unit(-k_ * (m + between - path_.before - path_.between)),
                    at_first,
                    at_second);
        });
    return sum;
}

TermProducts DoubleIntegral::integral() const noexcept {
    const WedgePoint second = seen_from_first(path_.second_z);
    const WedgePoint first = seen_from_second(path_.first_z);
    const double min_scale = kMinScale * (edges_.second_end - edges_.second_begin);
    const auto distance_to_first = [&](double z) {
        return std::max(min_scale, seen_from_first(z).radius);
    };
    // Both peaks lie in one place only at the shortest path, and either may leave the first edge at
    // its ends.
    const double first_pole = terms_at_first(second).pole();
    const double second_pole = terms_at_second(first).pole();
    const double peak =
        peak_width(source_, second, first_pole) + peak_width(first, listener_, second_pole);
    const WedgePoint source_about_second =
        geometry::wedge_coordinates(edges_.second, edges_.source);
    std::array<SteepPlace, 9> steep{
        SteepPlace{listener_.z, listener_.radius},
        SteepPlace{source_about_second.z, std::max(source_about_second.radius, min_scale)},
        SteepPlace{path_.second_z, peak},
        SteepPlace{edges_.second_begin, distance_to_first(edges_.second_begin)},
        SteepPlace{edges_.second_end, distance_to_first(edges_.second_end)}};
    std::size_t next = 5;
    for (const double end : {edges_.first_begin, edges_.first_end}) {
        const WedgePoint point = seen_from_second(end);
        steep[next++] = {apex_z(point, listener_),
                         std::max(min_scale, peak_width(point, listener_, second_pole))};
        const double z = place_of_peak(end);
        const double m = distance_at(source_, end);
        const double link_length = link(end, z);
        steep[next++] = {z, std::max(min_scale, first_pole * link_length * (m + link_length) / m)};
    }
    const auto phase = [&](double first_z) {
        return [this, first_z](double z) {
            return k_ * (link(first_z, z) + distance_at(listener_, z));
        };
    };
    const auto at_begin = phase(edges_.first_begin);
    const auto at_end = phase(edges_.first_end);
    const auto at_path = phase(path_.first_z);
    // No way over the second edge is shorter than past the first one.
    const auto detour = [&](double z) {
        return distance_at(source_about_second, z) + distance_at(listener_, z) - path_.length();
    };
    const geometry::Interval part =
        below(max_detour_, edges_.second_begin, edges_.second_end, path_.second_z, detour);
    TermProducts sum;
    integrate_graded(
        part.min,
        part.max,
        steep,
        [&](double z) {
            return std::max({at_begin(z), at_end(z), at_path(z)});
        },
        [&](double z, double weight) {
            const double l = distance_at(listener_, z);
            sum.add(weight / l * unit(-k_ * (l - path_.after)), inner(z));
        });
    return sum;
}

double DoubleIntegral::bound() const noexcept {
    const TermProducts sums = integral();
    double total = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            total += sums.at(i, j).real();
        }
    }
    return factor() * total;
}

DoublyDiffractedPressure DoubleIntegral::value() const noexcept {
    const Complex phased = factor() * unit(-k_ * path_.length());
    const TermProducts sums = integral();
    // A term keeps its sign over the edges but where a zone boundary crosses them; the sign at the
    // shortest way, where the response begins, is taken.
    const auto first = edge_terms(edges_.first.open_angle,
                                  source_.angle,
                                  seen_from_first(path_.second_z).angle,
                                  {1.0, 1.0, 1.0},
                                  {});
    const auto second = edge_terms(edges_.second.open_angle,
                                   seen_from_second(path_.first_z).angle,
                                   listener_.angle,
                                   {1.0, 1.0, 1.0},
                                   {});
    DoublyDiffractedPressure pressure;
    for (std::size_t i = 0; i < first.size(); ++i) {
        for (std::size_t j = 0; j < second.size(); ++j) {
            const bool is_upright = first[i].sign * second[j].sign > 0.0;
            auto& kinds = is_upright ? pressure.upright : pressure.inverted;
            kinds[first[i].kind][second[j].kind] += phased * sums.at(i, j);
        }
    }
    return pressure;
}

}  // namespace

std::complex<double> DoublyDiffractedPressure::total() const noexcept {
    Complex sum{0.0};
    for (const Kinds* kinds : {&upright, &inverted}) {
        for (const auto& of_first : *kinds) {
            for (const Complex& pressure : of_first) {
                sum += pressure;
            }
        }
    }
    return sum;
}

double max_doubly_diffracted_pressure(const DoubleDiffraction& edges) noexcept {
    constexpr double kQuadrature = 1.01;
    return kQuadrature * DoubleIntegral(edges, 0.0, kMaxSecondOrderPhase).bound();
}

DoublyDiffractedPressure doubly_diffracted_pressure(const DoubleDiffraction& edges,
                                                    double wave_number,
                                                    double max_phase) noexcept {
    EARSHOT_ASSERT(wave_number > 0.0);
    return DoubleIntegral(edges, wave_number, max_phase).value();
}

std::complex<double> second_order_pressure(const DoubleDiffraction& edges,
                                           double wave_number) noexcept {
    return doubly_diffracted_pressure(edges, wave_number).total();
}

std::complex<double> utd_second_order_pressure(const DoubleDiffraction& edges,
                                               double wave_number) noexcept {
    const DoublePath path = shortest_path(edges);
    const WedgePoint source = geometry::wedge_coordinates(edges.first, edges.source);
    const WedgePoint listener = geometry::wedge_coordinates(edges.second, edges.listener);
    WedgePoint second =
        geometry::wedge_coordinates(edges.first, edges.second.point_at(path.second_z));
    WedgePoint first =
        geometry::wedge_coordinates(edges.second, edges.first.point_at(path.first_z));
    if (edges.common_face) {
        second.angle = edges.common_face->of_first == 0 ? 0.0 : edges.first.open_angle;
        first.angle = edges.common_face->of_second == 0 ? 0.0 : edges.second.open_angle;
    }
    const double first_sine = source.radius / path.before;
    const double second_sine = listener.radius / path.after;
    // Each wedge sees the distance to the other one, not the length of the whole way.
    const Complex at_first = utd_coefficient(
        edges.first.open_angle,
        source.angle,
        second.angle,
        first_sine,
        path.before * path.between * first_sine * first_sine / (path.before + path.between),
        wave_number);
    const Complex at_second = utd_coefficient(
        edges.second.open_angle,
        first.angle,
        listener.angle,
        second_sine,
        path.between * path.after * second_sine * second_sine / (path.between + path.after),
        wave_number);
    const double half = edges.common_face ? 0.5 : 1.0;
    return half * at_first * at_second * unit(-wave_number * path.length()) /
           std::sqrt(path.before * path.between * path.after * path.length());
}

}  // namespace earshot::propagation
