// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/triangle_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

// What two triangles have to do with each other, found by other means than the library's: whole
// numbers and parting axes, or every pair of features in extended precision.
namespace earshot::test {

__extension__ using Whole = __int128;
using WholeVec = std::array<Whole, 3>;
using WholeCorners = std::array<WholeVec, 3>;

inline WholeVec minus(const WholeVec& a, const WholeVec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline WholeVec cross(const WholeVec& a, const WholeVec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Whole dot(const WholeVec& a, const WholeVec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline bool parts(const WholeVec& axis, const WholeCorners& one, const WholeCorners& other) {
    const auto [low, high] = std::minmax({dot(axis, one[0]), dot(axis, one[1]), dot(axis, one[2])});
    const auto [least, most] =
        std::minmax({dot(axis, other[0]), dot(axis, other[1]), dot(axis, other[2])});
    return high < least || most < low;
}

/// Whether two triangles, segments or points share a point. Coordinates up to 2^24. Tries more axes
/// than enough: edges, lines between corners, normals of any two, and what is normal to a normal
/// and an edge.
inline bool meet_exactly(const WholeCorners& one, const WholeCorners& other) {
    std::vector<WholeVec> lines;
    for (std::size_t i = 0; i < 3; ++i) {
        lines.push_back(minus(one[(i + 1) % 3], one[i]));
        lines.push_back(minus(other[(i + 1) % 3], other[i]));
    }
    for (const WholeVec& a : one) {
        for (const WholeVec& b : other) {
            lines.push_back(minus(b, a));
        }
    }
    for (const WholeVec& line : lines) {
        if (parts(line, one, other)) {
            return false;
        }
        for (const WholeVec& second : lines) {
            const WholeVec normal = cross(line, second);
            if (parts(normal, one, other)) {
                return false;
            }
            for (std::size_t edge = 0; edge < 6; ++edge) {
                if (parts(cross(normal, lines[edge]), one, other)) {
                    return false;
                }
            }
        }
    }
    return true;
}

using Long = std::array<long double, 3>;

inline long double dot(const Long& a, const Long& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The squared length of gap + a combination of `along` (at most four) that makes it shortest with
/// all weights of a feature's corners at least 0; infinite where there is none inside.
/// `of_one` says how many of the directions are the first triangle's.
inline long double shortest_squared(const Long& gap,
                                    const std::vector<Long>& along,
                                    std::size_t of_one) {
    const std::size_t n = along.size();
    std::array<std::array<long double, 5>, 4> m{};
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < n; ++k) {
            m[i][k] = dot(along[i], along[k]);
        }
        m[i][n] = -dot(along[i], gap);
    }
    for (std::size_t i = 0; i < n; ++i) {
        std::size_t pivot = i;
        for (std::size_t k = i; k < n; ++k) {
            pivot = std::abs(m[k][i]) > std::abs(m[pivot][i]) ? k : pivot;
        }
        std::swap(m[i], m[pivot]);
        if (m[i][i] == 0.0L) {
            return HUGE_VALL;
        }
        for (std::size_t k = 0; k < n; ++k) {
            if (k != i) {
                const long double factor = m[k][i] / m[i][i];
                for (std::size_t j = i; j <= n; ++j) {
                    m[k][j] -= factor * m[i][j];
                }
            }
        }
    }
    Long rest = gap;
    std::array<long double, 2> sums{};
    for (std::size_t i = 0; i < n; ++i) {
        const long double weight = m[i][n] / m[i][i];
        sums[i < of_one ? 0 : 1] += weight;
        if (weight < 0.0L) {
            return HUGE_VALL;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            rest[k] += weight * along[i][k];
        }
    }
    return sums[0] <= 1.0L && sums[1] <= 1.0L ? dot(rest, rest) : HUGE_VALL;
}

/// The distance of two triangles over all pairs of a corner, edge or face of each; of those that
/// meet some number that is no smaller than rounding makes it.
inline long double feature_distance(const collision::Corners& one,
                                    const collision::Corners& other) {
    const std::array<std::vector<std::size_t>, 7> features = {
        {{0}, {1}, {2}, {0, 1}, {1, 2}, {2, 0}, {0, 1, 2}}};
    const auto difference =
        [](const geometry::Vec3& a, const geometry::Vec3& b, long double scale) {
            Long d{};
            for (int k = 0; k < 3; ++k) {
                d[static_cast<std::size_t>(k)] =
                    scale * (static_cast<long double>(a[k]) - static_cast<long double>(b[k]));
            }
            return d;
        };
    long double least = HUGE_VALL;
    for (const auto& p : features) {
        for (const auto& q : features) {
            std::vector<Long> along;
            for (std::size_t i = 1; i < p.size(); ++i) {
                along.push_back(difference(one[p[i]], one[p[0]], 1.0L));
            }
            for (std::size_t i = 1; i < q.size(); ++i) {
                along.push_back(difference(other[q[i]], other[q[0]], -1.0L));
            }
            const Long gap = difference(one[p[0]], other[q[0]], 1.0L);
            if (p.size() + q.size() <= 5) {  // two faces are nearest at a border
                least = std::min(least, shortest_squared(gap, along, p.size() - 1));
            }
        }
    }
    return std::sqrt(least);
}

}  // namespace earshot::test
