// SPDX-License-Identifier: MIT
#include "earshot/collision/separation.h"

#include "earshot/base/assert.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <vector>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// A box of time and the two coordinates of the place; sides are powers of two.
struct Box {
    std::array<double, 3> least{}, size{1.0, 1.0, 1.0};
};

/// The earliest first, of those the largest.
struct IsLater {
    bool operator()(const Box& a, const Box& b) const {
        if (a.least[0] != b.least[0]) {
            return a.least[0] > b.least[0];
        }
        const double volume_a = a.size[0] * a.size[1] * a.size[2];
        const double volume_b = b.size[0] * b.size[1] * b.size[2];
        if (volume_a != volume_b) {
            return volume_a < volume_b;
        }
        return a.least > b.least;
    }
};

Vec3 between(const Vec3& a, const Vec3& b, double share) {
    return (1.0 - share) * a + share * b;
}

/// From the one feature to the other at a time and place.
template <bool kIsFace>
Vec3 offset(const MovingPoints& points, double t, double u, double v) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = between(points.begin[i], points.end[i], t);
    }
    if constexpr (kIsFace) {
        return x[0] - ((1.0 - u - v) * x[1] + u * x[2] + v * x[3]);
    } else {
        return between(x[0], x[1], u) - between(x[2], x[3], v);
    }
}

/// What the offset takes over a box: it is linear in each coordinate, so the corners bound it.
template <bool kIsFace>
void range_over(const MovingPoints& points, const Box& box, Vec3& least, Vec3& most) {
    for (int corner = 0; corner < 8; ++corner) {
        const auto at = [&](std::size_t i) {
            return box.least[i] + ((corner >> i & 1) != 0 ? box.size[i] : 0.0);
        };
        const Vec3 value = offset<kIsFace>(points, at(0), at(1), at(2));
        least = corner == 0 ? value : glm::min(least, value);
        most = corner == 0 ? value : glm::max(most, value);
    }
}

/// Lengths that the offset covers along each coordinate of the box, at most.
template <bool kIsFace>
std::array<double, 3> extents(const MovingPoints& points) {
    std::array<double, 3> result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (int corner = 0; corner < 4; ++corner) {
            std::array<double, 3> low{};
            low[(i + 1) % 3] = corner & 1 ? 1.0 : 0.0;
            low[(i + 2) % 3] = corner & 2 ? 1.0 : 0.0;
            std::array<double, 3> high = low;
            high[i] = 1.0;
            const Vec3 way = glm::abs(offset<kIsFace>(points, high[0], high[1], high[2]) -
                                      offset<kIsFace>(points, low[0], low[1], low[2]));
            result[i] = std::max({result[i], way.x, way.y, way.z});
        }
    }
    return result;
}

/// Some 20 roundings of numbers no larger than three times the largest coordinate.
double rounding_of(const MovingPoints& points) {
    double largest = 0.0;
    for (const auto* at : {&points.begin, &points.end}) {
        for (const Vec3& point : *at) {
            for (int axis = 0; axis < 3; ++axis) {
                largest = std::max(largest, std::abs(point[axis]));
            }
        }
    }
    return 0x1p-46 * largest;
}

template <bool kIsFace>
std::optional<double> time_within(const MovingPoints& points, const SeparationOptions& options) {
    EARSHOT_ASSERT(options.least_separation >= 0.0 && options.tolerance > 0.0);
    constexpr int kMostBoxes = 200000;
    const double near = options.least_separation + rounding_of(points);
    const std::array<double, 3> extent = extents<kIsFace>(points);
    std::priority_queue<Box, std::vector<Box>, IsLater> open;
    open.push({});
    for (int boxes = 0; !open.empty(); ++boxes) {
        const Box box = open.top();
        open.pop();
        Vec3 least(0.0), most(0.0);
        range_over<kIsFace>(points, box, least, most);
        bool is_far = false;
        for (int axis = 0; axis < 3; ++axis) {
            is_far = is_far || least[axis] > near || most[axis] < -near;
        }
        if (is_far) {
            continue;
        }
        std::size_t longest = 0;
        for (std::size_t i = 1; i < 3; ++i) {
            if (extent[i] * box.size[i] > extent[longest] * box.size[longest]) {
                longest = i;
            }
        }
        constexpr double kSmallest = 0x1p-48;
        if (extent[longest] * box.size[longest] <= options.tolerance / 3.0 ||
            box.size[longest] <= kSmallest || boxes >= kMostBoxes) {
            return box.least[0];
        }
        Box half = box;
        half.size[longest] *= 0.5;
        open.push(half);
        half.least[longest] += half.size[longest];
        // Beyond the third edge of the triangle there is nothing.
        if (!kIsFace || half.least[1] + half.least[2] <= 1.0) {
            open.push(half);
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<double> vertex_face_time_within(const MovingPoints& points,
                                              const SeparationOptions& options) {
    return time_within<true>(points, options);
}

std::optional<double> edge_edge_time_within(const MovingPoints& points,
                                            const SeparationOptions& options) {
    return time_within<false>(points, options);
}

}  // namespace earshot::collision
