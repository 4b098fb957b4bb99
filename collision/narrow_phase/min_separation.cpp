// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/min_separation.h"

#include "earshot/base/assert.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <vector>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// A box of time and the two barycentric coordinates; sides are powers of two.
struct Box {
    std::array<double, 3> lower{}, size{1.0, 1.0, 1.0};
};

/// The earliest first, of those the smallest: of several contacts at once any one will do.
struct IsLater {
    bool operator()(const Box& a, const Box& b) const {
        if (a.lower[0] != b.lower[0]) {
            return a.lower[0] > b.lower[0];
        }
        const double volume_a = a.size[0] * a.size[1] * a.size[2];
        const double volume_b = b.size[0] * b.size[1] * b.size[2];
        if (volume_a != volume_b) {
            return volume_a > volume_b;
        }
        return a.lower > b.lower;
    }
};

Vec3 lerp(const Vec3& a, const Vec3& b, double t) {
    return (1.0 - t) * a + t * b;
}

/// The vector between the features at a time and barycentric coordinates.
template <bool kIsFace>
Vec3 offset(const MovingPoints& points, double t, double u, double v) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = lerp(points.begin[i], points.end[i], t);
    }
    if constexpr (kIsFace) {
        return x[0] - ((1.0 - u - v) * x[1] + u * x[2] + v * x[3]);
    } else {
        return lerp(x[0], x[1], u) - lerp(x[2], x[3], v);
    }
}

/// The offset at the corners of a box. It is linear in each coordinate, so over the box it stays
/// within the convex hull of these. Bit i of a corner's index selects its end along coordinate i.
struct Offsets {
    std::array<std::array<double, 8>, 3> at{};

    Vec3 corner(std::size_t i) const { return {at[0][i], at[1][i], at[2][i]}; }

    /// Whether a direction separates the offsets from the cube of half side `distance`. The
    /// direction need not be exact; it is scaled so that nothing underflows.
    bool separated_along(const Vec3& direction, double distance) const {
        const Vec3 sizes = glm::abs(direction);
        const double size = std::max({sizes.x, sizes.y, sizes.z});
        if (!(size > 1e-200 && size < 1e200)) {
            return false;
        }
        const Vec3 d = direction / size;
        const double radius = distance * (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
        double lower = std::numeric_limits<double>::infinity(), upper = -lower;
        for (std::size_t i = 0; i < 8; ++i) {
            const double projection = d.x * at[0][i] + d.y * at[1][i] + d.z * at[2][i];
            lower = std::min(lower, projection);
            upper = std::max(upper, projection);
        }
        return lower > radius || upper < -radius;
    }
};

template <bool kIsFace>
Offsets offsets_over(const MovingPoints& points, const Box& box) {
    Offsets offsets;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const auto at = [&](std::size_t i) {
            return box.lower[i] + ((corner >> i & 1) != 0 ? box.size[i] : 0.0);
        };
        const Vec3 value = offset<kIsFace>(points, at(0), at(1), at(2));
        for (int axis = 0; axis < 3; ++axis) {
            offsets.at[static_cast<std::size_t>(axis)][corner] = value[axis];
        }
    }
    return offsets;
}

/// Whether all offsets of a box are farther away than `distance` along some axis: separating-axis
/// test of the cube of that half side and the offsets of a small box, which are almost a
/// parallelepiped. Directions: the axes, the normals of its faces, the cross products of edges, and
/// the direction to its middle orthogonal to its longest edge.
bool disjoint(const Offsets& offsets, double distance) {
    constexpr std::array<Vec3, 3> kAxes{Vec3(1.0, 0.0, 0.0), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (const Vec3& axis : kAxes) {
        if (offsets.separated_along(axis, distance)) {
            return true;
        }
    }
    std::array<Vec3, 3> edges;
    std::size_t longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        edges[i] = offsets.corner(std::size_t{1} << i) - offsets.corner(0);
        longest =
            glm::dot(edges[i], edges[i]) > glm::dot(edges[longest], edges[longest]) ? i : longest;
    }
    const Vec3 middle = 0.5 * (offsets.corner(0) + offsets.corner(7));
    if (offsets.separated_along(glm::cross(edges[1], edges[2]), distance) ||
        offsets.separated_along(glm::cross(edges[0], edges[1]), distance) ||
        offsets.separated_along(glm::cross(edges[0], edges[2]), distance) ||
        offsets.separated_along(glm::cross(glm::cross(edges[longest], middle), edges[longest]),
                                distance)) {
        return true;
    }
    return std::any_of(edges.begin(), edges.end(), [&](const Vec3& edge) {
        return std::any_of(kAxes.begin(), kAxes.end(), [&](const Vec3& axis) {
            return offsets.separated_along(glm::cross(axis, edge), distance);
        });
    });
}

/// Whether the features are within `distance` at one of the corners at the beginning of a box.
template <bool kIsFace>
bool begins_within(const Offsets& offsets, const Box& box, double distance) {
    for (std::size_t corner = 0; corner < 8; corner += 2) {
        const double u = box.lower[1] + ((corner & 2) != 0 ? box.size[1] : 0.0);
        const double v = box.lower[2] + ((corner & 4) != 0 ? box.size[2] : 0.0);
        const Vec3 sizes = glm::abs(offsets.corner(corner));
        if ((!kIsFace || u + v <= 1.0) && std::max({sizes.x, sizes.y, sizes.z}) <= distance) {
            return true;
        }
    }
    return false;
}

/// Upper bounds of how far the offset moves along each coordinate of the unit box.
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
            const Vec3 moved = glm::abs(offset<kIsFace>(points, high[0], high[1], high[2]) -
                                        offset<kIsFace>(points, low[0], low[1], low[2]));
            result[i] = std::max({result[i], moved.x, moved.y, moved.z});
        }
    }
    return result;
}

/// Bound of 30 roundings of numbers up to three times the largest coordinate, and of underflow.
double rounding_of(const MovingPoints& points) {
    double largest = 0.0;
    for (const auto* at : {&points.begin, &points.end}) {
        for (const Vec3& point : *at) {
            for (int axis = 0; axis < 3; ++axis) {
                largest = std::max(largest, std::abs(point[axis]));
            }
        }
    }
    return 0x1p-45 * largest + 1e-300;
}

template <bool kIsFace>
std::optional<double> min_separation_ccd(const MovingPoints& points,
                                         const MinSeparationOptions& options) {
    EARSHOT_ASSERT(options.min_separation >= 0.0 && options.tolerance > 0.0);
    constexpr int kMaxBoxes = 200000;
    const double distance = options.min_separation + rounding_of(points);
    const std::array<double, 3> extent = extents<kIsFace>(points);
    std::priority_queue<Box, std::vector<Box>, IsLater> queue;
    queue.push({});
    for (int boxes = 0; !queue.empty(); ++boxes) {
        const Box box = queue.top();
        queue.pop();
        const Offsets offsets = offsets_over<kIsFace>(points, box);
        if (disjoint(offsets, distance)) {
            continue;
        }
        // No other box is earlier.
        if (begins_within<kIsFace>(offsets, box, distance)) {
            return box.lower[0];
        }
        std::size_t longest = 0;
        for (std::size_t i = 1; i < 3; ++i) {
            if (extent[i] * box.size[i] > extent[longest] * box.size[longest]) {
                longest = i;
            }
        }
        constexpr double kMinSize = 0x1p-48;
        if (extent[longest] * box.size[longest] <= options.tolerance / 3.0 ||
            box.size[longest] <= kMinSize || boxes >= kMaxBoxes) {
            return box.lower[0];
        }
        Box half = box;
        half.size[longest] *= 0.5;
        queue.push(half);
        half.lower[longest] += half.size[longest];
        // Boxes beyond the third edge of the triangle are left out.
        if (!kIsFace || half.lower[1] + half.lower[2] <= 1.0) {
            queue.push(half);
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<double> vertex_face_min_separation_ccd(const MovingPoints& points,
                                                     const MinSeparationOptions& options) {
    return min_separation_ccd<true>(points, options);
}

std::optional<double> edge_edge_min_separation_ccd(const MovingPoints& points,
                                                   const MinSeparationOptions& options) {
    return min_separation_ccd<false>(points, options);
}

}  // namespace earshot::collision
