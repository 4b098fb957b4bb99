// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/propagation/internal/complex_math.h"
#include "earshot/propagation/internal/edge_terms.h"
#include "earshot/propagation/internal/level_curve.h"
#include "earshot/propagation/internal/oscillatory_quadrature.h"
#include "earshot/propagation/internal/wedge_terms.h"
#include "earshot/propagation/second_order_diffraction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace earshot::propagation {

using geometry::Interval;
using geometry::WedgePoint;

namespace {

/// Of products of the four terms at the first edge with the four at the second.
using Products = std::array<double, 16>;

/// Of a panel over length: its length over the distance to a singularity.
constexpr double kMaxPanelRatio = 1.5;
/// Of a panel along a level curve, in the variable in which peaks are stretched.
constexpr double kMaxPanelStretch = 2.0;

/// A length at which the response is singular, or nearly.
struct Feature {
    double length = 0.0;
    double scale = 0.0;         ///< metres: not resolved closer
    bool is_two_sided = false;  ///< also for shorter lengths; else from there on
    bool is_break = true;       ///< no panel may contain it
};

/// A place on a level curve where the integrand has a peak.
struct Peak {
    double angle = 0.0;
    double width = 1.0;
};

/// Radians of phase at the highest frequency: structure of the response below it is not resolved.
constexpr double kMinScalePhase = 0.2;

/// The same as a part of all lengths.
constexpr double kMinScale = 1e-4;

/// Radians along a level curve: peaks that are narrower are taken as this wide. Poles are narrow,
/// roots of a radius are of no weight within their width.
constexpr double kMinPeakWidth = 1e-9;
constexpr double kMinRootWidth = 1e-4;

constexpr double kTurn = 2.0 * math::kPi;

double apex(const WedgePoint& before, const WedgePoint& after) noexcept {
    return (before.z * after.radius + after.z * before.radius) / (before.radius + after.radius);
}

/// The sine of half of |eta| at which a wedge's integrand is singular, on the imaginary axis: at
/// the pole of its closest term, or where two ways become one.
double singular_sine(const WedgeTerms& terms, double nu) noexcept {
    const double eta = 2.0 * math::asin(std::min(1.0, terms.min_half_sine())) / nu;
    return math::sin(0.5 * std::min(eta, math::kPi));
}

/// What the double integral has at each length of the way: its impulse response, per product of
/// terms.
class PairResponse {
public:
    PairResponse(const DoubleDiffraction& edges, double max_wave_number)
        : pair_(edges),
          path_(shortest_path(edges)),
          first_terms_(edges.first.open_angle, pair_.source().angle, true),
          second_terms_(edges.second.open_angle, pair_.listener().angle, false),
          some_first_(terms_at_first(path_.second_z)),
          some_second_(terms_at_second(path_.first_z)),
          closest_(pair_.closest_points()),
          min_scale_(kMinScalePhase / max_wave_number) {
        double longest = min_length();
        for (const double first : {pair_.part(0).min, pair_.part(0).max}) {
            for (const double second : {pair_.part(1).min, pair_.part(1).max}) {
                longest = std::max(longest, pair_.length({first, second}));
            }
        }
        min_scale_ = std::min(min_scale_, kMinScale * (longest - min_length()));
        boundaries_ = {find_boundaries(0), find_boundaries(1)};
        for (const std::size_t edge : {std::size_t{0}, std::size_t{1}}) {
            const LineAbout& line = over_other(edge).line();
            closest_to_line_[edge] = line.closest_in(pair_.part(edge));
            gap_[edge] = line.radius(closest_to_line_[edge]) / line.radius_slope();
        }
    }

    double min_length() const noexcept { return path_.length(); }
    const DoublePath& path() const noexcept { return path_; }
    const EdgePairGeometry& pair() const noexcept { return pair_; }

    /// Panels over the length, ascending.
    std::vector<Interval> panels() const;
    Products at(double length) const;

private:
    WedgeTerms terms_at_first(double second_z) const noexcept {
        return first_terms_.at(pair_.second_about_first().angle(second_z));
    }
    WedgeTerms terms_at_second(double first_z) const noexcept {
        return second_terms_.at(pair_.first_about_second().angle(first_z));
    }
    WedgeTerms terms_of(std::size_t edge, double z_of_other) const noexcept {
        return edge == 0 ? terms_at_first(z_of_other) : terms_at_second(z_of_other);
    }
    /// The reduced length as a function of the place on an edge.
    const ReducedLength& over_other(std::size_t edge) const noexcept {
        return edge == 0 ? pair_.over_second() : pair_.over_first();
    }
    double nu(std::size_t edge) const noexcept {
        return edge == 0 ? first_terms_.nu() : second_terms_.nu();
    }
    double peak_scale(std::size_t edge, double z_of_other) const noexcept;

    std::vector<Feature> features() const;
    void add_side(std::size_t edge, double end, std::vector<Feature>& features) const;
    void add_crossing(std::size_t edge, double end, std::vector<Feature>& features) const;
    std::vector<double> find_boundaries(std::size_t edge) const;
    std::vector<Peak> peaks_of(const LevelCurve& curve) const;
    void add_closest(const LevelCurve& curve, std::size_t edge, std::vector<Peak>& peaks) const;
    void integrate(const LevelCurve& curve,
                   const Peak& peak,
                   const Interval& part,
                   Products& sums) const;
    void add(const LevelCurve& curve, double angle, double weight, Products& sums) const;

    EdgePairGeometry pair_;
    DoublePath path_;
    DirectedTerms first_terms_, second_terms_;
    WedgeTerms some_first_, some_second_;
    /// Of an edge's own terms: places on the other edge where zone boundaries cross it.
    std::array<std::vector<double>, 2> boundaries_;
    std::array<double, 2> closest_;  // of the points of both parts
    double min_scale_;
    /// Of each edge the place that is closest to the line of the other, and how far along the edge
    /// that is seen: the distance over the sine of the angle between both.
    std::array<double, 2> closest_to_line_{};
    std::array<double, 2> gap_{};
};

// Metres behind the shortest way over the line of the edge, to a place on the other one, within
// which the edge's terms change.
double PairResponse::peak_scale(std::size_t edge, double z_of_other) const noexcept {
    const ReducedLength& over = over_other(1 - edge);
    const double sine = singular_sine(terms_of(edge, z_of_other), nu(edge));
    return 2.0 * over.inner().radius * over.line().radius(z_of_other) * sine * sine /
           over.before(z_of_other);
}

// Ways over an end of one edge. The shortest of them begins what is missing beyond that end.
void PairResponse::add_side(std::size_t edge, double end, std::vector<Feature>& features) const {
    const ReducedLength& over = over_other(edge);
    const double other = apex(over.line().at(end), over.inner());
    const Interval& part = pair_.part(1 - edge);
    const bool is_inside = other > part.min && other < part.max;
    features.push_back(
        {over.value(end), std::min(min_scale_, peak_scale(1 - edge, end)), false, is_inside});
}

// Where the peak of the edge's own terms leaves the edge at an end.
void PairResponse::add_crossing(std::size_t edge,
                                double end,
                                std::vector<Feature>& features) const {
    const ReducedLength& over = over_other(1 - edge);
    const Interval& part = pair_.part(1 - edge);
    const auto apex_of = [&](double z) { return apex(over.inner(), over.line().at(z)) - end; };
    double low = part.min, high = part.max;
    const bool is_above = apex_of(low) > 0.0;
    if ((apex_of(high) > 0.0) == is_above) {
        return;
    }
    constexpr int kHalvings = 40;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        ((apex_of(middle) > 0.0) == is_above ? low : high) = middle;
    }
    const double z = 0.5 * (low + high);
    const double sine = singular_sine(terms_of(edge, z), nu(edge));
    constexpr double kWide = 0.5;
    if (sine > kWide) {
        return;
    }
    const auto eta = [&](double place) {
        return asinh((end - over.inner().z) / over.inner().radius) +
               asinh((end - over.line().axial(place)) / over.line().radius(place));
    };
    const auto length = [&](double place) {
        return edge == 0 ? pair_.length({end, place}) : pair_.length({place, end});
    };
    const double step = 1e-4 * (part.max - part.min);
    const double slope = std::abs(eta(z + step) - eta(z - step));
    const double rise = std::abs(length(z + step) - length(z - step));
    features.push_back({length(z), rise * 2.0 * sine / slope, true, true});
}

std::vector<double> PairResponse::find_boundaries(std::size_t edge) const {
    const ReducedLength& over = over_other(1 - edge);
    std::vector<double> places;
    if (over.line().has_fixed_angle()) {
        return places;
    }
    const double open_angle = math::kPi / nu(edge);
    const Interval& part = pair_.part(1 - edge);
    for (const double sign : {1.0, -1.0}) {
        for (const double of_end : {1.0, -1.0}) {
            for (const double turns : {-1.0, 0.0, 1.0}) {
                const double angle =
                    sign * (2.0 * turns * open_angle - math::kPi - of_end * over.inner().angle);
                const double z = over.line().place_at(angle);
                if (angle > 0.0 && angle < open_angle && z > part.min && z < part.max) {
                    places.push_back(z);
                }
            }
        }
    }
    return places;
}

std::vector<Feature> PairResponse::features() const {
    std::vector<Feature> features;
    const bool is_inside = path_.first_z > pair_.part(0).min && path_.first_z < pair_.part(0).max &&
                           path_.second_z > pair_.part(1).min && path_.second_z < pair_.part(1).max;
    const double of_peaks = std::min(peak_scale(0, path_.second_z), peak_scale(1, path_.first_z));
    features.push_back(
        {min_length(), is_inside ? of_peaks : std::min(of_peaks, min_scale_), false, true});
    for (const std::size_t edge : {std::size_t{0}, std::size_t{1}}) {
        // The peak changes its sign.
        for (const double z : boundaries_[edge]) {
            const ReducedLength& over = over_other(1 - edge);
            const Interval& part = pair_.part(edge);
            const double place =
                std::clamp(apex(over.inner(), over.line().at(z)), part.min, part.max);
            features.push_back({edge == 0 ? pair_.length({place, z}) : pair_.length({z, place}),
                                min_scale_,
                                true,
                                true});
        }
        for (const double end : {pair_.part(edge).min, pair_.part(edge).max}) {
            add_side(edge, end, features);
            add_crossing(edge, end, features);
        }
    }
    for (const double first : {pair_.part(0).min, pair_.part(0).max}) {
        for (const double second : {pair_.part(1).min, pair_.part(1).max}) {
            features.push_back({pair_.length({first, second}),
                                std::numeric_limits<double>::infinity(),
                                false,
                                true});
        }
    }
    features.push_back(
        {pair_.length(closest_), std::max(pair_.link(closest_), min_scale_), true, true});
    return features;
}

std::vector<Interval> PairResponse::panels() const {
    const std::vector<Feature> features = this->features();
    std::vector<double> breaks;
    for (const Feature& feature : features) {
        if (feature.is_break) {
            breaks.push_back(feature.length);
        }
    }
    std::sort(breaks.begin(), breaks.end());
    constexpr double kSmallest = 1e-12;  // of the length: rounding
    constexpr double kMinFeature = 1e-10;
    const double smallest = kSmallest * breaks.back();
    std::vector<Interval> panels;
    double from = min_length();
    for (const double to : breaks) {
        while (to - from > smallest) {
            double size = to - from;
            for (const Feature& feature : features) {
                const double gap = from - feature.length;
                const double scale = std::max(kMinFeature * breaks.back(), feature.scale);
                if (gap >= -smallest) {
                    size = std::min(size, kMaxPanelRatio * std::max(gap, scale));
                } else if (feature.is_two_sided) {
                    size = std::min(size,
                                    std::max(kMaxPanelRatio * scale,
                                             -gap * kMaxPanelRatio / (1.0 + kMaxPanelRatio)));
                }
            }
            size = std::max(size, smallest);
            // No short panel is left over.
            const double end = size > 0.7 * (to - from) ? to : from + size;
            panels.push_back({from, end});
            from = end;
        }
    }
    return panels;
}

// Where an edge comes close to the line of the other, its radius about it and its angle turn.
void PairResponse::add_closest(const LevelCurve& curve,
                               std::size_t edge,
                               std::vector<Peak>& peaks) const {
    if (gap_[edge] > pair_.part(edge).max - pair_.part(edge).min) {
        return;
    }
    constexpr double kStep = 1e-3;
    constexpr double kMaxWidth = 0.7;
    const auto angles = curve.angles_at(edge, closest_to_line_[edge]);
    if (!angles) {
        return;
    }
    for (const double angle : *angles) {
        const double by = curve.at(angle + kStep).z[edge] - curve.at(angle).z[edge];
        const double width = kStep * gap_[edge] / std::abs(by);
        if (width < kMaxWidth) {
            peaks.push_back({angle < 0.0 ? angle + kTurn : angle, std::max(kMinRootWidth, width)});
        }
    }
}

std::vector<Peak> PairResponse::peaks_of(const LevelCurve& curve) const {
    std::vector<Peak> peaks;
    const auto add = [&](double angle, double width) {
        // Not a number where both ends of a width vanish.
        peaks.push_back({angle < 0.0 ? angle + kTurn : angle,
                         width < 1.0 ? std::max(width, kMinPeakWidth) : 1.0});
    };
    for (const double side : {1.0, -1.0}) {
        const double z = curve.turn(side);
        const ReducedLength& over = pair_.over_first();
        const double sine = singular_sine(terms_at_first(z), first_terms_.nu());
        const double width =
            sine * std::sqrt(4.0 * over.inner().radius * over.line().radius(z) /
                             (over.before(z) * std::abs(over.slope(z)) * curve.half_width()));
        add(side * 0.5 * math::kPi, width);
    }
    for (const double side : {1.0, -1.0}) {
        const double angle = curve.extreme_of_first(side);
        const LevelCurve::Point point = curve.at(angle);
        const double sine = singular_sine(terms_at_second(point.z[0]), second_terms_.nu());
        const double link = pair_.link(point.z);
        const double after = pair_.over_first().after(point.z[1]);
        const double width = 2.0 * sine * link * after /
                             ((link + after) * curve.half_width() * std::abs(math::cos(angle)));
        add(angle, width);
    }
    add_closest(curve, 0, peaks);
    add_closest(curve, 1, peaks);
    std::sort(
        peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.angle < b.angle; });
    return peaks;
}

/// e^{nu x}, of e^x.
double power_of(double exponential, double nu) noexcept {
    return nu == 0.5 ? std::sqrt(exponential) : math::exp(nu * math::log(exponential));
}

/// x + sqrt(1 + x^2) = e^{asinh x}.
double exponential_of_asinh(double x) noexcept {
    const double sum = std::abs(x) + std::sqrt(1.0 + x * x);
    return x < 0.0 ? 1.0 / sum : sum;
}

void PairResponse::add(const LevelCurve& curve, double angle, double weight, Products& sums) const {
    const LevelCurve::Point point = curve.at(angle);
    const LineAbout& line = pair_.first_about_second();
    const WedgePoint& listener = pair_.listener();
    const double second_exponential =
        exponential_of_asinh((point.z[1] - line.axial(point.z[0])) / line.radius(point.z[0])) *
        exponential_of_asinh((point.z[1] - listener.z) / listener.radius);
    const double first_root = power_of(point.first_root, first_terms_.nu());
    const double second_root = power_of(std::sqrt(second_exponential), second_terms_.nu());
    const auto first = pair_.second_about_first().has_fixed_angle()
                           ? some_first_.values(first_root)
                           : terms_at_first(point.z[1]).values(first_root);
    const auto second = line.has_fixed_angle() ? some_second_.values(second_root)
                                               : terms_at_second(point.z[0]).values(second_root);
    for (std::size_t i = 0; i < first.size(); ++i) {
        const double weighted = weight * point.measure * first[i];
        for (std::size_t j = 0; j < second.size(); ++j) {
            sums[4 * i + j] += weighted * second[j];
        }
    }
}

// With t = peak + width sinh x the peak, whose poles lie at x = +- j pi / 2, is as smooth as the
// rest.
void PairResponse::integrate(const LevelCurve& curve,
                             const Peak& peak,
                             const Interval& part,
                             Products& sums) const {
    const double from = asinh(part.min / peak.width);
    const double to = asinh(part.max / peak.width);
    const double panels = std::ceil((to - from) / kMaxPanelStretch);
    const double half = 0.5 * (to - from) / panels;
    for (double panel = 0.0; panel < panels; ++panel) {
        const double centre = from + (2.0 * panel + 1.0) * half;
        for (std::size_t i = 0; i < kPanelNodes; ++i) {
            const double x = centre + half * panel_positions()[i];
            const double sinh_x = sinh(x);
            add(curve,
                peak.angle + peak.width * sinh_x,
                half * panel_weights()[i] * peak.width * std::sqrt(1.0 + sinh_x * sinh_x),
                sums);
        }
    }
}

Products PairResponse::at(double length) const {
    const LevelCurve curve(pair_, length);
    Products sums{};
    if (!(curve.half_width() > 0.0)) {
        return sums;
    }
    const std::vector<Interval> parts = curve.parts_on_edges();
    const std::vector<Peak> peaks = peaks_of(curve);
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        // Each peak serves the angles that are closer to it than to others.
        const double angle = peaks[i].angle;
        const double before = i > 0 ? peaks[i - 1].angle : peaks.back().angle - kTurn;
        const double after =
            i + 1 < peaks.size() ? peaks[i + 1].angle : peaks.front().angle + kTurn;
        for (const Interval& part : parts) {
            for (const double shift : {-kTurn, 0.0, kTurn}) {
                const Interval about{std::max(0.5 * (before - angle), part.min + shift - angle),
                                     std::min(0.5 * (after - angle), part.max + shift - angle)};
                if (about.min < about.max) {
                    integrate(curve, peaks[i], about, sums);
                }
            }
        }
    }
    return sums;
}

}  // namespace

struct EdgePairSpectrum::Panel {
    double middle = 0.0;  // metres behind the shortest way
    double half_length = 0.0;
    std::array<Products, kPanelNodes> response{};
};

EdgePairSpectrum::EdgePairSpectrum(EdgePairSpectrum&&) noexcept = default;
EdgePairSpectrum& EdgePairSpectrum::operator=(EdgePairSpectrum&&) noexcept = default;
EdgePairSpectrum::~EdgePairSpectrum() = default;

EdgePairSpectrum::EdgePairSpectrum(const DoubleDiffraction& edges, double max_wave_number) {
    EARSHOT_ASSERT(max_wave_number > 0.0);
    const PairResponse response(edges, max_wave_number);
    min_length_ = response.min_length();
    for (const Interval& interval : response.panels()) {
        Panel& panel = panels_.emplace_back();
        const double middle = 0.5 * (interval.min + interval.max);
        panel.middle = middle - min_length_;
        panel.half_length = 0.5 * (interval.max - interval.min);
        for (std::size_t i = 0; i < kPanelNodes; ++i) {
            panel.response[i] = response.at(middle + panel.half_length * panel_positions()[i]);
        }
    }
    const double half = edges.common_face ? 0.5 : 1.0;
    factor_ = half / (16.0 * edges.first.open_angle * edges.second.open_angle);
    // A term keeps its sign over the edges but where a zone boundary crosses them; the sign at the
    // shortest way, where the response begins, is taken.
    const DoublePath& path = response.path();
    const auto first = edge_terms(edges.first.open_angle,
                                  response.pair().source().angle,
                                  response.pair().second_about_first().angle(path.second_z),
                                  {1.0, 1.0, 1.0},
                                  {});
    const auto second = edge_terms(edges.second.open_angle,
                                   response.pair().first_about_second().angle(path.first_z),
                                   response.pair().listener().angle,
                                   {1.0, 1.0, 1.0},
                                   {});
    for (std::size_t i = 0; i < first.size(); ++i) {
        for (std::size_t j = 0; j < second.size(); ++j) {
            is_upright_[4 * i + j] = first[i].sign * second[j].sign > 0.0;
        }
    }
}

DoublyDiffractedPressure EdgePairSpectrum::pressure(double wave_number) const noexcept {
    EARSHOT_ASSERT(wave_number > 0.0);
    std::array<Complex, 16> sums{};
    for (const Panel& panel : panels_) {
        const Complex turn = panel.half_length * unit(-wave_number * panel.middle);
        const auto weights = oscillatory_weights(wave_number * panel.half_length);
        for (std::size_t node = 0; node < kPanelNodes; ++node) {
            const Complex weight = turn * weights[node];
            for (std::size_t i = 0; i < sums.size(); ++i) {
                sums[i] += panel.response[node][i] * weight;
            }
        }
    }
    const Complex phased = factor_ * unit(-wave_number * min_length_);
    constexpr std::array<std::size_t, 4> kKinds{0, 0, 1, 2};
    DoublyDiffractedPressure pressure;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            auto& kinds = is_upright_[4 * i + j] ? pressure.upright : pressure.inverted;
            kinds[kKinds[i]][kKinds[j]] += phased * sums[4 * i + j];
        }
    }
    return pressure;
}

double EdgePairSpectrum::sum_of_amplitudes() const noexcept {
    double sum = 0.0;
    for (const Panel& panel : panels_) {
        for (std::size_t node = 0; node < kPanelNodes; ++node) {
            for (const double value : panel.response[node]) {
                sum += panel.half_length * panel_weights()[node] * std::abs(value);
            }
        }
    }
    return factor_ * sum;
}

}  // namespace earshot::propagation
