// SPDX-License-Identifier: MIT
// The double integral over two edges against the published one, its parts, and its bound.
#include "earshot/propagation/second_order_diffraction.h"

#include "earshot/base/math.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using Complex = std::complex<double>;
using geometry::Vec3;
using geometry::Wedge;
using geometry::WedgePoint;
using support::Dice;

/// Of a source or a listener from an edge, and of angles from the faces.
constexpr double kMinRadius = 0.1;
constexpr double kMinAngle = 0.02;

Vec3 random_point(Dice& dice, double reach) {
    return {dice.between(-reach, reach), dice.between(-reach, reach), dice.between(-reach, reach)};
}

bool is_in_air(const Wedge& wedge, const Vec3& point) {
    const WedgePoint at = geometry::wedge_coordinates(wedge, point);
    return at.radius > kMinRadius && at.angle > kMinAngle &&
           at.angle < wedge.open_angle - kMinAngle;
}

/// Seen from an edge's line another turns by less than half a turn: by more if its way leads
/// through what is behind the faces.
bool is_in_air(const Wedge& wedge, const Wedge& other) {
    const double turn = geometry::wedge_coordinates(wedge, other.begin).angle -
                        geometry::wedge_coordinates(wedge, other.end).angle;
    return is_in_air(wedge, other.begin) && is_in_air(wedge, other.end) &&
           std::abs(turn) < math::kPi;
}

bool lies_before(const Wedge& edge, const Wedge& other) {
    const auto before = [&](const Vec3& point) {
        return glm::dot(point - edge.begin, edge.tangent) > kMinRadius;
    };
    return before(other.begin) && before(other.end);
}

/// Two edges whose ways run through the air, or along a face in the plane y = 0.
std::optional<DoubleDiffraction> random_edges(Dice& dice, bool has_common_face) {
    constexpr double kReach = 2.0;
    constexpr double kMinLength = 0.3;
    DoubleDiffraction edges;
    std::array<Vec3, 4> corners{};
    for (Vec3& corner : corners) {
        corner = random_point(dice, kReach);
        corner.y = has_common_face ? 0.0 : corner.y;
    }
    const double first_angle = dice.between(1.1, 2.0) * math::kPi;
    const double second_angle = dice.between(1.1, 2.0) * math::kPi;
    const Vec3 in_face = has_common_face ? corners[2] : random_point(dice, kReach);
    edges.first = geometry::make_wedge(corners[0], corners[1], in_face, first_angle);
    edges.second = geometry::make_wedge(corners[2],
                                        corners[3],
                                        has_common_face ? corners[0] : random_point(dice, kReach),
                                        second_angle);
    if (has_common_face && glm::dot(edges.first.normal, edges.second.normal) < 0.0) {
        edges.second = geometry::make_wedge(corners[3], corners[2], corners[0], second_angle);
    }
    edges.source = random_point(dice, 3.0);
    edges.listener = random_point(dice, 3.0);
    edges.first_end = edges.first.length();
    edges.second_end = edges.second.length();
    if (edges.first_end < kMinLength || edges.second_end < kMinLength ||
        !is_in_air(edges.first, edges.source) || !is_in_air(edges.second, edges.listener)) {
        return std::nullopt;
    }
    if (has_common_face) {
        edges.common_face = DoubleDiffraction::CommonFace{0, 0};
        return lies_before(edges.first, edges.second) && lies_before(edges.second, edges.first)
                   ? std::optional(edges)
                   : std::nullopt;
    }
    return is_in_air(edges.first, edges.second) && is_in_air(edges.second, edges.first)
               ? std::optional(edges)
               : std::nullopt;
}

struct Nodes {
    std::vector<double> positions, weights;  // on [0, 1]
};

/// Gauss and Legendre's, by Newton's method.
Nodes gauss_nodes(int count) {
    Nodes nodes;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(math::kPi * (i + 0.75) / (count + 0.5));
        double slope = 0.0;
        for (int step = 0; step < 20; ++step) {
            double before = 1.0, value = x;
            for (int n = 2; n <= count; ++n) {
                before = std::exchange(value, ((2 * n - 1) * x * value - (n - 1) * before) / n);
            }
            slope = count * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        nodes.positions.push_back(0.5 * (x + 1.0));
        nodes.weights.push_back(1.0 / ((1.0 - x * x) * slope * slope));
    }
    return nodes;
}

/// sum over phi of nu sin(nu phi) / (cosh(nu eta) - cos(nu phi)).
double published_terms(double open_angle, const WedgePoint& from, const WedgePoint& to, double z) {
    const double nu = math::kPi / open_angle;
    const double eta = std::asinh((z - from.z) / from.radius) + std::asinh((z - to.z) / to.radius);
    double sum = 0.0;
    for (const double a : {1.0, -1.0}) {
        for (const double b : {1.0, -1.0}) {
            const double phi = math::kPi + a * from.angle + b * to.angle;
            sum += nu * std::sin(nu * phi) / (std::cosh(nu * eta) - std::cos(nu * phi));
        }
    }
    return sum;
}

/// Svensson, Fred and Vanderkooy (1999) as it stands, over the points of both edges.
Complex published_integral(const DoubleDiffraction& edges, double k, const Nodes& nodes) {
    const std::size_t count = nodes.positions.size();
    const WedgePoint source = geometry::wedge_coordinates(edges.first, edges.source);
    const WedgePoint listener = geometry::wedge_coordinates(edges.second, edges.listener);
    Complex sum{0.0};
    for (std::size_t i = 0; i < count; ++i) {
        const double z1 = edges.first_end * nodes.positions[i];
        const Vec3 first = edges.first.point_at(z1);
        WedgePoint about_second = geometry::wedge_coordinates(edges.second, first);
        about_second.angle = edges.common_face ? 0.0 : about_second.angle;
        const double m = glm::distance(edges.source, first);
        for (std::size_t j = 0; j < count; ++j) {
            const double z2 = edges.second_end * nodes.positions[j];
            const Vec3 second = edges.second.point_at(z2);
            WedgePoint about_first = geometry::wedge_coordinates(edges.first, second);
            about_first.angle = edges.common_face ? 0.0 : about_first.angle;
            const double between = glm::distance(first, second);
            const double l = glm::distance(second, edges.listener);
            sum += nodes.weights[i] * nodes.weights[j] / (m * between * l) *
                   published_terms(edges.first.open_angle, source, about_first, z1) *
                   published_terms(edges.second.open_angle, about_second, listener, z2) *
                   std::polar(1.0, -k * (m + between + l));
        }
    }
    const double half = edges.common_face ? 0.5 : 1.0;
    return half / (16.0 * math::kPi * math::kPi) * edges.first_end * edges.second_end * sum;
}

TEST(EdgePairSpectrum, EqualsThePublishedIntegral) {
    const Nodes coarse = gauss_nodes(60);
    const Nodes fine = gauss_nodes(96);
    Dice dice(1);
    int compared = 0;
    for (int i = 0; i < 500; ++i) {
        const auto edges = random_edges(dice, i % 2 == 0);
        if (!edges) {
            continue;
        }
        const EdgePairSpectrum spectrum(*edges, 30.0);
        const double length = shortest_path(*edges).length();
        for (const double k : {1.0, 12.0}) {
            // The published integrand is singular where a zone boundary crosses an edge.
            const Complex expected = published_integral(*edges, k, fine);
            if (std::abs(published_integral(*edges, k, coarse) - expected) * length < 1e-6) {
                EXPECT_LT(std::abs(spectrum.pressure(k).total() - expected) * length, 2e-6) << i;
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 60);
}

// Zone boundaries that cross the edges included, where the published integrand is singular: parts
// of edges have panels of their own.
TEST(EdgePairSpectrum, PartsOfEdgesAddUp) {
    Dice dice(2);
    int compared = 0;
    for (int i = 0; compared < 15; ++i) {
        const auto edges = random_edges(dice, i % 4 == 0);
        if (!edges) {
            continue;
        }
        const EdgePairSpectrum whole(*edges, 100.0);
        const double at_first = dice.between(0.2, 0.8) * edges->first_end;
        const double at_second = dice.between(0.2, 0.8) * edges->second_end;
        std::vector<EdgePairSpectrum> parts;
        for (int part = 0; part < 4; ++part) {
            DoubleDiffraction some = *edges;
            (part % 2 == 0 ? some.first_end : some.first_begin) = at_first;
            (part < 2 ? some.second_end : some.second_begin) = at_second;
            parts.emplace_back(some, 100.0);
        }
        const double length = shortest_path(*edges).length();
        for (const double k : {0.5, 5.0, 30.0, 100.0}) {
            Complex sum{0.0};
            for (const EdgePairSpectrum& part : parts) {
                sum += part.pressure(k).total();
            }
            EXPECT_LT(std::abs(sum - whole.pressure(k).total()) * length, 1e-5) << i << " k " << k;
        }
        ++compared;
    }
}

TEST(EdgePairSpectrum, OfOneFrequencyIsThatOfAll) {
    Dice dice(3);
    for (int i = 0; i < 100; ++i) {
        if (const auto edges = random_edges(dice, i % 2 == 0)) {
            const EdgePairSpectrum spectrum(*edges, 300.0);
            for (const double k : {0.5, 20.0}) {
                const Complex all = spectrum.pressure(k).total();
                EXPECT_LT(std::abs(second_order_pressure(*edges, k) - all), 1e-5 * std::abs(all));
            }
        }
    }
}

/// The largest sum of any terms of one sign, of one kind or of all.
/// With each kind at either edge there or not.
double loudest_sum(const DoublyDiffractedPressure& pressure) {
    const auto has = [](unsigned kinds, std::size_t kind) { return (kinds >> kind & 1U) != 0; };
    double loudest = 0.0;
    for (unsigned first = 1; first < 8; ++first) {
        for (unsigned second = 1; second < 8; ++second) {
            Complex sum{0.0};
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    if (has(first, i) && has(second, k)) {
                        sum += pressure.upright[i][k] + pressure.inverted[i][k];
                    }
                }
            }
            loudest = std::max(loudest, std::abs(sum));
        }
    }
    return loudest;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

TEST(MaxDoublyDiffractedPressure, IsNeverBelowAnySumOfTerms) {
    constexpr int kHalvings = 40;
    Dice dice(4);
    std::vector<double> excess_db, excess_of_pieces_db;
    for (int i = 0; i < 700; ++i) {
        auto edges = random_edges(dice, i % 2 == 0);
        if (!edges) {
            continue;
        }
        const double of_whole = max_doubly_diffracted_pressure(*edges);
        double loudest = 0.0;
        // Of a part less is heard; the bound of the whole holds for it, too.
        const bool is_part = dice.chance(0.5);
        if (is_part) {
            edges->first_begin = dice.between(0.0, 0.9) * edges->first_end;
            edges->second_end *= dice.between(0.1, 1.0);
        }
        const EdgePairSpectrum spectrum(*edges, 300.0);
        for (double k = 0.01; k < 300.0; k *= 3.0) {
            loudest = std::max(loudest, loudest_sum(spectrum.pressure(k)));
        }
        const double of_part = max_doubly_diffracted_pressure(*edges);
        ASSERT_LE(loudest, of_part) << i;
        ASSERT_LE(of_part, of_whole * (1.0 + 1e-12)) << i;
        excess_db.push_back(20.0 * std::log10(of_part / loudest));
        // Of pieces, down to where it would no longer be below what is heard.
        const double of_pieces = max_doubly_diffracted_pressure({&*edges, 1}, 0.0, kHalvings);
        ASSERT_LE(loudest, of_pieces) << i;
        ASSERT_LE(of_pieces, of_part * (1.0 + 1e-12)) << i;
        excess_of_pieces_db.push_back(20.0 * std::log10(of_pieces / loudest));
    }
    ASSERT_GT(excess_db.size(), 120U);
    EXPECT_LT(median(excess_db), 27.0);
    EXPECT_LT(median(excess_of_pieces_db), median(excess_db) - 3.0);
}

/// The loudest of some frequencies, of the kinds times their factors at both edges.
double loudest_of(const EdgePairSpectrum& spectrum,
                  const std::array<double, 3>& at_first,
                  const std::array<double, 3>& at_second,
                  bool only_one_reflects) {
    double loudest = 0.0;
    for (double k = 0.01; k < 300.0; k *= 3.0) {
        const DoublyDiffractedPressure pressure = spectrum.pressure(k);
        Complex sum{0.0};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                if (!only_one_reflects || i == 0 || j == 0) {
                    sum += at_first[i] * at_second[j] *
                           (pressure.upright[i][j] + pressure.inverted[i][j]);
                }
            }
        }
        loudest = std::max(loudest, std::abs(sum));
    }
    return loudest;
}

// The factors are known but for a tenth, and terms of unlike sign cancel.
TEST(MaxDoublyDiffractedPressure, HoldsForFactorsOfTerms) {
    constexpr int kHalvings = 60;
    Dice dice(8);
    std::vector<double> gain_db;
    for (int i = 0; i < 500; ++i) {
        const auto edges = random_edges(dice, i % 2 == 0);
        if (!edges) {
            continue;
        }
        std::array<std::array<double, 3>, 2> factors{};
        TermFactors ranges{};
        for (std::size_t edge = 0; edge < 2; ++edge) {
            for (std::size_t kind = 0; kind < 3; ++kind) {
                const double least = dice.between(0.5, 0.9);
                factors[edge][kind] = least + dice.between(0.0, 0.1);
                ranges[edge][kind] = {least, least + 0.1};
            }
        }
        const EdgePairSpectrum spectrum(*edges, 300.0);
        const double error = 1e-5 / shortest_path(*edges).length();
        const auto bound = [&](std::span<const TermFactors> choices) {
            return max_doubly_diffracted_pressure({&*edges, 1}, 0.0, kHalvings, choices);
        };
        const double of_all = bound({&ranges, 1});
        ASSERT_LE(loudest_of(spectrum, factors[0], factors[1], false), of_all + error) << i;
        // At the first edge no reflection, or one there and none at the second.
        TermFactors none_at_first = ranges, just_at_first = ranges;
        none_at_first[0][1] = none_at_first[0][2] = {0.0, 0.0};
        just_at_first[0][0] = just_at_first[1][1] = just_at_first[1][2] = {0.0, 0.0};
        ASSERT_LE(loudest_of(spectrum, factors[0], factors[1], true),
                  bound(std::array{none_at_first, just_at_first}) + error)
            << i;
        const double of_any = max_doubly_diffracted_pressure({&*edges, 1}, 0.0, kHalvings);
        gain_db.push_back(20.0 * std::log10(of_any / of_all));
    }
    ASSERT_GT(gain_db.size(), 80U);
    EXPECT_GT(median(gain_db), 3.0);
}

// A thin plate: edges with a common end, from which they are at no distance.
TEST(MaxDoublyDiffractedPressure, HoldsForEdgesThatMeet) {
    Dice dice(5);
    for (int i = 0; i < 60; ++i) {
        const Vec3 corner(0.0), a(dice.between(0.3, 2.0), 0, 0);
        const Vec3 b(dice.between(-1.0, 1.0), 0, dice.between(0.3, 2.0));
        DoubleDiffraction edges;
        edges.first = geometry::make_wedge(corner, a, b, 2.0 * math::kPi);
        edges.second = geometry::make_wedge(b, corner, a, 2.0 * math::kPi);
        edges.source = random_point(dice, 3.0);
        edges.listener = random_point(dice, 3.0);
        edges.first_end = edges.first.length();
        edges.second_end = edges.second.length();
        edges.common_face = DoubleDiffraction::CommonFace{0, 0};
        if (is_in_air(edges.first, edges.source) && is_in_air(edges.second, edges.listener)) {
            const EdgePairSpectrum spectrum(edges, 100.0);
            for (const double k : {0.01, 1.0, 10.0, 100.0}) {
                const double loudest = loudest_sum(spectrum.pressure(k));
                ASSERT_LE(loudest, max_doubly_diffracted_pressure(edges));
                ASSERT_LE(loudest, max_doubly_diffracted_pressure({&edges, 1}, 0.0, 30));
            }
        }
    }
}

}  // namespace
}  // namespace earshot::propagation
