// SPDX-License-Identifier: MIT
#include "earshot/propagation/second_order_diffraction.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

double distance_between(const Vec3& a, const Vec3& b) noexcept {
    return std::sqrt(glm::dot(b - a, b - a));
}

/// The length of the way over two edges and its derivatives by the places on them. It is convex.
struct PathLength {
    double value = 0.0;
    std::array<double, 2> gradient{};
    std::array<double, 2> second{};  // derivatives by one place
    double mixed = 0.0;
};

PathLength path_length(const DoubleDiffraction& edges, const std::array<double, 2>& z) noexcept {
    const Vec3& t1 = edges.first.direction;
    const Vec3& t2 = edges.second.direction;
    const Vec3 first = edges.first.point_at(z[0]);
    const Vec3 second = edges.second.point_at(z[1]);
    const double before = distance_between(edges.source, first);
    const double between = distance_between(first, second);
    const double after = distance_between(second, edges.listener);
    // Components of the unit vectors of the legs along the edges.
    const double before_1 = glm::dot(first - edges.source, t1) / before;
    const double after_2 = glm::dot(second - edges.listener, t2) / after;
    const Vec3 way = between > 0.0 ? (second - first) / between : Vec3(0.0);
    const double way_1 = glm::dot(way, t1);
    const double way_2 = glm::dot(way, t2);
    // Where the edges meet the length has a corner; its derivatives are those of the other legs.
    const double inverse = between > 0.0 ? 1.0 / between : 0.0;
    return {before + between + after,
            {before_1 - way_1, after_2 + way_2},
            {(1.0 - before_1 * before_1) / before + (1.0 - way_1 * way_1) * inverse,
             (1.0 - after_2 * after_2) / after + (1.0 - way_2 * way_2) * inverse},
            (way_1 * way_2 - glm::dot(t1, t2)) * inverse};
}

}  // namespace

// Newton's method within the rectangle of both parts: a place at an end that the length still falls
// towards stays there, and steps are halved until the length falls.
DoublePath shortest_path(const DoubleDiffraction& edges) noexcept {
    const std::array<double, 2> low{edges.first_begin, edges.second_begin};
    const std::array<double, 2> high{edges.first_end, edges.second_end};
    std::array<double, 2> z{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
    PathLength length = path_length(edges, z);
    constexpr int kMaxSteps = 60;
    constexpr int kMaxHalvings = 40;
    for (int step = 0; step < kMaxSteps; ++step) {
        std::array<bool, 2> is_free{};
        for (std::size_t i = 0; i < 2; ++i) {
            is_free[i] = !(z[i] <= low[i] && length.gradient[i] > 0.0) &&
                         !(z[i] >= high[i] && length.gradient[i] < 0.0);
        }
        std::array<double, 2> move{};
        const auto [g0, g1] = length.gradient;
        const double determinant =
            length.second[0] * length.second[1] - length.mixed * length.mixed;
        if (is_free[0] && is_free[1] && determinant > 0.0) {
            move = {-(g0 * length.second[1] - g1 * length.mixed) / determinant,
                    -(g1 * length.second[0] - g0 * length.mixed) / determinant};
        } else {
            for (std::size_t i = 0; i < 2; ++i) {
                move[i] = is_free[i] && length.second[i] > 0.0
                              ? -length.gradient[i] / length.second[i]
                              : 0.0;
            }
        }
        bool has_moved = false;
        for (int halving = 0; halving < kMaxHalvings && !has_moved; ++halving) {
            std::array<double, 2> next{};
            for (std::size_t i = 0; i < 2; ++i) {
                next[i] = std::clamp(z[i] + std::ldexp(move[i], -halving), low[i], high[i]);
            }
            const PathLength next_length = path_length(edges, next);
            if (next_length.value < length.value) {
                z = next;
                length = next_length;
                has_moved = true;
            }
        }
        if (!has_moved) {
            break;
        }
    }
    const Vec3 first = edges.first.point_at(z[0]);
    const Vec3 second = edges.second.point_at(z[1]);
    return {z[0],
            z[1],
            distance_between(edges.source, first),
            distance_between(first, second),
            distance_between(second, edges.listener)};
}

}  // namespace earshot::propagation
