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

/// A box of time and the two coordinates of the place; sides are powers of two.
struct Box {
    std::array<double, 3> least{}, size{1.0, 1.0, 1.0};
};

/// The earliest first, of those the smallest: where much is near at once, any of it will do.
struct IsLater {
    bool operator()(const Box& a, const Box& b) const {
        if (a.least[0] != b.least[0]) {
            return a.least[0] > b.least[0];
        }
        const double volume_a = a.size[0] * a.size[1] * a.size[2];
        const double volume_b = b.size[0] * b.size[1] * b.size[2];
        if (volume_a != volume_b) {
            return volume_a > volume_b;
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

/// The offset at the corners of a box; it is linear in each coordinate, so it stays within their
/// convex hull over the box. Bit i of a corner's number tells its end along coordinate i.
struct Offsets {
    std::array<std::array<double, 8>, 3> at{};

    Vec3 corner(std::size_t i) const { return {at[0][i], at[1][i], at[2][i]}; }

    /// Whether all lie farther along a direction than anything does that is near. A direction need
    /// not be exact, as it is scaled to a size at which nothing vanishes.
    bool is_beyond(const Vec3& direction, double near) const {
        const Vec3 sizes = glm::abs(direction);
        const double size = std::max({sizes.x, sizes.y, sizes.z});
        if (!(size > 1e-200 && size < 1e200)) {
            return false;
        }
        const Vec3 d = direction / size;
        const double reach = near * (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (std::size_t i = 0; i < 8; ++i) {
            const double place = d.x * at[0][i] + d.y * at[1][i] + d.z * at[2][i];
            least = std::min(least, place);
            most = std::max(most, place);
        }
        return least > reach || most < -reach;
    }
};

template <bool kIsFace>
Offsets offsets_over(const MovingPoints& points, const Box& box) {
    Offsets offsets;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const auto at = [&](std::size_t i) {
            return box.least[i] + ((corner >> i & 1) != 0 ? box.size[i] : 0.0);
        };
        const Vec3 value = offset<kIsFace>(points, at(0), at(1), at(2));
        for (int axis = 0; axis < 3; ++axis) {
            offsets.at[static_cast<std::size_t>(axis)][corner] = value[axis];
        }
    }
    return offsets;
}

/// Whether nothing of a box is near: along the axes, or along what parts the cube of what is near
/// from a small box's offsets, which are almost those of a parallelepiped: the normals of its
/// faces, what is normal to an edge of each, and the way to its middle across its longest edge.
bool is_far(const Offsets& offsets, double near) {
    constexpr std::array<Vec3, 3> kAxes{Vec3(1.0, 0.0, 0.0), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (const Vec3& axis : kAxes) {
        if (offsets.is_beyond(axis, near)) {
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
    if (offsets.is_beyond(glm::cross(edges[1], edges[2]), near) ||
        offsets.is_beyond(glm::cross(edges[0], edges[1]), near) ||
        offsets.is_beyond(glm::cross(edges[0], edges[2]), near) ||
        offsets.is_beyond(glm::cross(glm::cross(edges[longest], middle), edges[longest]), near)) {
        return true;
    }
    return std::any_of(edges.begin(), edges.end(), [&](const Vec3& edge) {
        return std::any_of(kAxes.begin(), kAxes.end(), [&](const Vec3& axis) {
            return offsets.is_beyond(glm::cross(axis, edge), near);
        });
    });
}

/// Whether something of the features is near at the beginning of a box: at one of its corners.
template <bool kIsFace>
bool begins_near(const Offsets& offsets, const Box& box, double near) {
    for (std::size_t corner = 0; corner < 8; corner += 2) {
        const double u = box.least[1] + ((corner & 2) != 0 ? box.size[1] : 0.0);
        const double v = box.least[2] + ((corner & 4) != 0 ? box.size[2] : 0.0);
        const Vec3 sizes = glm::abs(offsets.corner(corner));
        if ((!kIsFace || u + v <= 1.0) && std::max({sizes.x, sizes.y, sizes.z}) <= near) {
            return true;
        }
    }
    return false;
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

/// Some 30 roundings of numbers no larger than three times the largest coordinate, and what may
/// vanish.
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
std::optional<double> time_within(const MovingPoints& points, const MinSeparationOptions& options) {
    EARSHOT_ASSERT(options.min_separation >= 0.0 && options.tolerance > 0.0);
    constexpr int kMostBoxes = 200000;
    const double near = options.min_separation + rounding_of(points);
    const std::array<double, 3> extent = extents<kIsFace>(points);
    std::priority_queue<Box, std::vector<Box>, IsLater> open;
    open.push({});
    for (int boxes = 0; !open.empty(); ++boxes) {
        const Box box = open.top();
        open.pop();
        const Offsets offsets = offsets_over<kIsFace>(points, box);
        if (is_far(offsets, near)) {
            continue;
        }
        // Nothing that is left is earlier.
        if (begins_near<kIsFace>(offsets, box, near)) {
            return box.least[0];
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

std::optional<double> vertex_face_min_separation_ccd(const MovingPoints& points,
                                                     const MinSeparationOptions& options) {
    return time_within<true>(points, options);
}

std::optional<double> edge_edge_min_separation_ccd(const MovingPoints& points,
                                                   const MinSeparationOptions& options) {
    return time_within<false>(points, options);
}

}  // namespace earshot::collision
