// SPDX-License-Identifier: MIT
#include "earshot/propagation/diffraction.h"

#include "earshot/base/math.h"
#include "earshot/propagation/second_order_diffraction.h"
#include "earshot/propagation/uniform_diffraction.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

namespace earshot::propagation {
namespace {

using Complex = std::complex<double>;
using geometry::Vec3;
using support::Dice;

double apex_length(const EdgeDiffraction& edge) {
    return std::hypot(edge.source.radius + edge.listener.radius, edge.source.z - edge.listener.z);
}

EdgeDiffraction random_edge(Dice& dice) {
    EdgeDiffraction edge;
    edge.open_angle = dice.chance(0.3) ? 2.0 * math::kPi : dice.between(1.1, 1.99) * math::kPi;
    edge.source = {std::exp(dice.between(-3.0, 2.5)),
                   dice.between(0.0, 1.0) * edge.open_angle,
                   dice.between(-3.0, 3.0)};
    edge.listener = {std::exp(dice.between(-3.0, 2.5)),
                     dice.between(0.0, 1.0) * edge.open_angle,
                     dice.between(-3.0, 3.0)};
    edge.z_begin = dice.between(-4.0, 3.0);
    edge.z_end = edge.z_begin + std::exp(dice.between(-3.0, 2.0));
    return edge;
}

double random_wave_number(Dice& dice) {
    return 2.0 * math::kPi / 343.0 * std::exp(dice.between(std::log(25.0), std::log(1e4)));
}

/// Svensson et al. 1999, equation 7, as printed, by Simpson's rule.
Complex published_integral(const EdgeDiffraction& edge, double k, int steps) {
    const double nu = math::kPi / edge.open_angle;
    const double difference = edge.source.angle - edge.listener.angle;
    const double sum = edge.source.angle + edge.listener.angle;
    const auto integrand = [&](double z) {
        const double from_source = z - edge.source.z;
        const double from_listener = z - edge.listener.z;
        const double m = std::hypot(edge.source.radius, from_source);
        const double l = std::hypot(edge.listener.radius, from_listener);
        const double cosh_eta =
            (m * l + from_source * from_listener) / (edge.source.radius * edge.listener.radius);
        const double cosh_nu_eta = std::cosh(nu * std::acosh(std::max(1.0, cosh_eta)));
        double beta = 0.0;
        for (const double phi :
             {math::kPi + difference, math::kPi - difference, math::kPi + sum, math::kPi - sum}) {
            beta += std::sin(nu * phi) / (cosh_nu_eta - std::cos(nu * phi));
        }
        return beta * std::polar(1.0 / (m * l), -k * (m + l));
    };
    const double h = (edge.z_end - edge.z_begin) / steps;
    Complex total{0.0};
    for (int i = 0; i <= steps; ++i) {
        const double weight = i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        total += weight * integrand(edge.z_begin + i * h);
    }
    return -nu / (4.0 * math::kPi) * h / 3.0 * total;
}

TEST(Diffraction, EqualsThePublishedIntegral) {
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        Dice dice(seed);
        EdgeDiffraction edge = random_edge(dice);
        // As fine as Simpson's rule needs it.
        edge.source.radius += 0.3;
        edge.listener.radius += 0.3;
        const double k = std::min(random_wave_number(dice), 20.0);
        const double error =
            std::abs(diffracted_pressure(edge, k).total() - published_integral(edge, k, 6000)) *
            apex_length(edge);
        // Terms close to their zone boundary are steep: there the oracle is the coarser one.
        const double coarse =
            std::abs(published_integral(edge, k, 6000) - published_integral(edge, k, 3000)) *
            apex_length(edge);
        EXPECT_LT(error, 6e-5 + 2.0 * coarse) << "seed " << seed;
    }
}

TEST(Diffraction, IsTheSameEitherWayAndFromEitherFace) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        Dice dice(seed);
        const EdgeDiffraction edge = random_edge(dice);
        const double k = random_wave_number(dice);
        const Complex expected = diffracted_pressure(edge, k).total();
        EdgeDiffraction swapped = edge;
        std::swap(swapped.source, swapped.listener);
        EdgeDiffraction faces = edge;
        faces.source.angle = edge.open_angle - edge.source.angle;
        faces.listener.angle = edge.open_angle - edge.listener.angle;
        EdgeDiffraction reversed = edge;
        reversed.source.z = -edge.source.z;
        reversed.listener.z = -edge.listener.z;
        reversed.z_begin = -edge.z_end;
        reversed.z_end = -edge.z_begin;
        for (const EdgeDiffraction& other : {swapped, faces, reversed}) {
            EXPECT_LT(
                std::abs(diffracted_pressure(other, k).total() - expected) * apex_length(edge),
                1e-9)
                << "seed " << seed;
        }
    }
}

TEST(Diffraction, PartsOfAnEdgeAddUp) {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        Dice dice(seed);
        const EdgeDiffraction edge = random_edge(dice);
        const double k = random_wave_number(dice);
        Complex sum{0.0};
        for (int i = 0; i < 7; ++i) {
            EdgeDiffraction part = edge;
            const double length = edge.z_end - edge.z_begin;
            part.z_begin = edge.z_begin + length * i / 7;
            part.z_end = edge.z_begin + length * (i + 1) / 7;
            sum += diffracted_pressure(part, k).total();
        }
        EXPECT_LT(std::abs(diffracted_pressure(edge, k).total() - sum) * apex_length(edge), 6e-5)
            << "seed " << seed;
    }
}

TEST(Diffraction, ScalesWithLengthsAndWaves) {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        Dice dice(seed);
        const EdgeDiffraction edge = random_edge(dice);
        const double k = random_wave_number(dice);
        const double scale = std::exp(dice.between(-3.0, 3.0));
        EdgeDiffraction larger = edge;
        for (auto* point : {&larger.source, &larger.listener}) {
            point->radius *= scale;
            point->z *= scale;
        }
        larger.z_begin *= scale;
        larger.z_end *= scale;
        EXPECT_LT(std::abs(scale * diffracted_pressure(larger, k / scale).total() -
                           diffracted_pressure(edge, k).total()) *
                      apex_length(edge),
                  1e-8)
            << "seed " << seed;
    }
}

TEST(Diffraction, BoundIsNeverBelowThePressure) {
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Dice dice(seed);
        const EdgeDiffraction edge = random_edge(dice);
        const double k = random_wave_number(dice);
        const auto pressure = diffracted_pressure(edge, k);
        const double bound = max_diffracted_pressure(edge, k);
        // The pressure's own error is allowed for.
        const double slack = 6e-5 / apex_length(edge);
        EXPECT_GE(bound + slack, std::abs(pressure.total())) << "seed " << seed;
        EXPECT_LE(bound, 2.001 / shortest_length(edge)) << "seed " << seed;
    }
}

// With these angles the images in the corner are the whole sound field.
TEST(Diffraction, CornersThatDivideAHalfTurnDiffractNothing) {
    for (const double parts : {2.0, 3.0, 4.0}) {
        EdgeDiffraction edge;
        edge.open_angle = math::kPi / parts;
        edge.source = {1.3, 0.2, 0.1};
        edge.listener = {0.8, 0.7, -0.4};
        edge.z_begin = -2.0;
        edge.z_end = 3.0;
        EXPECT_LT(std::abs(diffracted_pressure(edge, 9.0).total()), 1e-12);
    }
}

TEST(Diffraction, ResponseHasTheSpectrumOfThePressure) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Dice dice(seed);
        EdgeDiffraction edge = random_edge(dice);
        edge.source.radius += 0.5;
        edge.listener.radius += 0.5;
        const double speed = 343.0;
        const double rate = 192000.0;
        const EdgeResponse response = diffraction_response(edge, rate, speed, 1U << 20);
        const double k = 2.0 * math::kPi * 500.0 / speed;
        Complex upright{0.0}, inverted{0.0};
        for (std::size_t i = 0; i < response.upright.size(); ++i) {
            const double length = response.first_length + static_cast<double>(i) * speed / rate;
            upright += std::polar(response.upright[i], -k * length);
            inverted += std::polar(response.inverted[i], -k * length);
            EXPECT_GE(response.upright[i], 0.0);
            EXPECT_LE(response.inverted[i], 0.0);
        }
        const auto pressure = diffracted_pressure(edge, k);
        const auto& [up, down] = pressure;
        EXPECT_LT(std::abs(upright - (up[0] + up[1] + up[2])) * apex_length(edge), 4e-3) << seed;
        EXPECT_LT(std::abs(inverted - (down[0] + down[1] + down[2])) * apex_length(edge), 4e-3)
            << seed;
        EXPECT_NEAR(response.first_length, shortest_length(edge), 0.51 * speed / rate) << seed;
    }
}

/// What reaches the listener without the edge's help: direct sound and both faces' reflections, of
/// a wedge without ends.
Complex geometrical_part(const EdgeDiffraction& edge, double k) {
    const auto image = [&](double angle) {
        const double rs = edge.source.radius;
        const double rr = edge.listener.radius;
        const double rise = edge.listener.z - edge.source.z;
        const double length =
            std::sqrt(rs * rs + rr * rr - 2.0 * rs * rr * std::cos(angle) + rise * rise);
        return std::polar(1.0 / length, -k * length);
    };
    const double difference = edge.listener.angle - edge.source.angle;
    const double sum = edge.listener.angle + edge.source.angle;
    Complex total{0.0};
    if (std::abs(difference) < math::kPi) {
        total += image(difference);
    }
    if (sum < math::kPi) {
        total += image(sum);
    }
    if (sum > 2.0 * edge.open_angle - math::kPi) {
        total += image(sum - 2.0 * edge.open_angle);
    }
    return total;
}

struct Sweep {
    double open_angle_deg, source_radius, source_angle_deg, listener_radius, rise;
    double z_begin, z_end;
};

const std::array<Sweep, 10> kSweeps{{{360, 2.0, 60, 2.0, 0.0, -5.0, 5.0},
                                     {360, 2.0, 60, 2.0, 0.0, -0.02, 4.0},
                                     {360, 0.5, 100, 6.0, 2.0, -3.0, 3.0},
                                     {270, 1.0, 50, 3.0, 1.0, -2.0, 4.0},
                                     {270, 3.0, 85, 0.4, -0.5, -2.0, 1.0},
                                     {270, 1.0, 10, 1.0, 0.0, -1.0, 1.0},
                                     {225, 3.0, 30, 1.5, -0.5, -3.0, 3.0},
                                     {300, 1.5, 110, 2.5, 0.3, -1.0, 0.8},
                                     {320, 0.2, 70, 0.3, 0.1, -0.5, 0.5},
                                     {200, 4.0, 15, 5.0, 3.0, -4.0, 6.0}}};

// 1,000 steps through a zone boundary, the closer the finer. The field itself is smooth, so that
// steps are in proportion to the angle; at the boundary the diffracted part alone steps by 1 / R0.
TEST(Diffraction, TotalFieldIsContinuousThroughZoneBoundaries) {
    constexpr int kSteps = 1000;
    constexpr double kReach = 8.0 * math::kPi / 180.0;
    for (const Sweep& sweep : kSweeps) {
        EdgeDiffraction edge;
        edge.open_angle = sweep.open_angle_deg * math::kPi / 180.0;
        edge.source = {sweep.source_radius, sweep.source_angle_deg * math::kPi / 180.0, 0.0};
        edge.z_begin = sweep.z_begin;
        edge.z_end = sweep.z_end;
        const double shadow = math::kPi + edge.source.angle;
        const double specular = math::kPi - edge.source.angle;
        for (const double boundary : {shadow, specular}) {
            for (const double frequency : {63.0, 500.0, 4000.0}) {
                const double k = 2.0 * math::kPi * frequency / 343.0;
                Complex previous_total{0.0}, previous_diffracted{0.0};
                double previous_angle = 0.0;
                double largest_jump = 0.0;
                for (int i = 1; i <= kSteps; ++i) {
                    const double x = 2.0 * (i - 0.5) / kSteps - 1.0;
                    const double angle = boundary + kReach * x * x * x;
                    edge.listener = {sweep.listener_radius, angle, sweep.rise};
                    const double shortest = apex_length(edge);
                    const Complex diffracted = diffracted_pressure(edge, k).total();
                    const Complex total = diffracted + geometrical_part(edge, k);
                    if (i > 1) {
                        const double step = std::abs(total - previous_total) * shortest;
                        // The phase turns by at most k times the listener's way.
                        const double turn = angle - previous_angle;
                        const double smooth = (4.0 + 3.0 * k * sweep.listener_radius) * turn *
                                              shortest / std::min(sweep.source_radius, 1.0);
                        EXPECT_LT(step, 1e-7 + smooth) << sweep.open_angle_deg << " " << i;
                        if (i == kSteps / 2 + 1) {
                            EXPECT_LT(step, 1e-6) << sweep.open_angle_deg << " " << frequency;
                        }
                        largest_jump = std::max(
                            largest_jump, std::abs(diffracted - previous_diffracted) * shortest);
                    }
                    previous_total = total;
                    previous_diffracted = diffracted;
                    previous_angle = angle;
                }
                EXPECT_NEAR(largest_jump, 1.0, 0.01);
            }
        }
    }
}

// On the boundary itself the angles do not decide; the specular answer does.
TEST(Diffraction, FollowsTheSpecularAnswerOnABoundary) {
    EdgeDiffraction edge;
    edge.open_angle = 1.5 * math::kPi;
    edge.source = {1.0, 0.8, 0.0};
    edge.listener = {2.0, 0.8 + math::kPi, 0.5};
    edge.z_begin = -3.0;
    edge.z_end = 3.0;
    const double k = 9.0;
    const double length = apex_length(edge);
    const Complex direct = std::polar(1.0 / length, -k * length);
    edge.sides[0] = ZoneSide::lit;
    const Complex lit = diffracted_pressure(edge, k).total() + direct;
    edge.sides[0] = ZoneSide::shadow;
    const Complex shadow = diffracted_pressure(edge, k).total();
    EXPECT_LT(std::abs(lit - shadow) * length, 1e-12);
    edge.listener.angle -= 1e-7;
    edge.sides[0] = ZoneSide::shadow;  // too far from the boundary to matter
    EXPECT_LT(std::abs(diffracted_pressure(edge, k).total() + direct - lit) * length, 1e-5);
}

TEST(Diffraction, UniformTheoryIsTheLimitOfLongEdges) {
    double worst_db = 0.0;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        Dice dice(seed);
        EdgeDiffraction edge;
        edge.open_angle = dice.between(200.0, 360.0) * math::kPi / 180.0;
        edge.source = {std::exp(dice.between(-1.0, 2.0)), 0.0, dice.between(-2.0, 2.0)};
        edge.source.angle = dice.between(0.0, edge.open_angle - math::kPi - 0.2);
        edge.listener = {std::exp(dice.between(-1.0, 2.0)), 0.0, dice.between(-2.0, 2.0)};
        edge.listener.angle = dice.between(edge.source.angle + math::kPi + 0.02, edge.open_angle);
        edge.z_begin = -1e4;
        edge.z_end = 1e4;
        const double k = dice.between(10.0, 100.0) * apex_length(edge) /
                         (edge.source.radius * edge.listener.radius);
        const double db = 20.0 * std::log10(std::abs(utd_pressure(edge, k)) /
                                            std::abs(diffracted_pressure(edge, k).total()));
        worst_db = std::max(worst_db, std::abs(db));
    }
    EXPECT_LT(worst_db, 0.03);
}

/// Two edges across a thick barrier, askew.
DoubleDiffraction skew_edges() {
    DoubleDiffraction edges;
    edges.first = geometry::make_wedge({-0.4, 0, -3}, {-0.4, 0, 3}, {0.4, 0, -3}, 1.5 * math::kPi);
    edges.second = geometry::make_wedge({0.4, 0, 3}, {0.9, 0, -3}, {-0.4, 0, 3}, 1.4 * math::kPi);
    edges.source = {-2.0, -1.0, 0.3};
    edges.listener = {3.0, -0.7, 1.0};
    edges.first_end = edges.first.length();
    edges.second_end = edges.second.length();
    edges.common_face = DoubleDiffraction::CommonFace{0, 0};
    return edges;
}

TEST(SecondOrderDiffraction, IsTheSameEitherWay) {
    const DoubleDiffraction edges = skew_edges();
    DoubleDiffraction reversed;
    reversed.first = edges.second;
    reversed.second = edges.first;
    reversed.source = edges.listener;
    reversed.listener = edges.source;
    reversed.first_end = edges.second_end;
    reversed.second_end = edges.first_end;
    reversed.common_face = edges.common_face;
    for (const double k : {1.0, 5.0, 20.0}) {
        const Complex there = second_order_pressure(edges, k);
        EXPECT_LT(std::abs(there - second_order_pressure(reversed, k)), 1e-6 * std::abs(there));
    }
}

TEST(SecondOrderDiffraction, PartsOfEdgesAddUp) {
    const DoubleDiffraction edges = skew_edges();
    Complex sum{0.0};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 2; ++j) {
            DoubleDiffraction part = edges;
            part.first_begin = edges.first_end * i / 3;
            part.first_end = edges.first_end * (i + 1) / 3;
            part.second_begin = edges.second_end * j / 2;
            part.second_end = edges.second_end * (j + 1) / 2;
            sum += second_order_pressure(part, 4.0);
        }
    }
    const Complex whole = second_order_pressure(edges, 4.0);
    EXPECT_LT(std::abs(whole - sum), 1e-6 * std::abs(whole));
}

TEST(SecondOrderDiffraction, ShortestPathIsShorterThanAllOthers) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        Dice dice(seed);
        const auto point = [&] {
            return Vec3(dice.between(-3, 3), dice.between(-3, 3), dice.between(-3, 3));
        };
        DoubleDiffraction edges;
        const Vec3 corner = point();
        edges.first = geometry::make_wedge(corner, point(), point(), 4.0);
        edges.second =
            geometry::make_wedge(dice.chance(0.3) ? corner : point(), point(), point(), 4.0);
        edges.source = point();
        edges.listener = point();
        edges.first_end = edges.first.length();
        edges.second_end = edges.second.length();
        const DoublePath path = shortest_path(edges);
        for (int i = 0; i <= 20; ++i) {
            for (int j = 0; j <= 20; ++j) {
                const Vec3 first = edges.first.point_at(edges.first_end * i / 20);
                const Vec3 second = edges.second.point_at(edges.second_end * j / 20);
                const double length = glm::distance(edges.source, first) +
                                      glm::distance(first, second) +
                                      glm::distance(second, edges.listener);
                EXPECT_GE(length, path.length() - 1e-7) << "seed " << seed;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::propagation
