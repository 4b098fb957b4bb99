// SPDX-License-Identifier: MIT
#include "earshot/geometry/fit.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/vector.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

namespace earshot::geometry {
namespace {

constexpr double kResolution = 0x1p-26;     // of directions, and relative to the extent of lengths
constexpr double kDirectionCell = 0x1p-20;  // of normals that count as one
constexpr std::size_t kMaxDirections = 8;

double rounded(double value, double unit) noexcept {
    return unit > 0.0 ? std::nearbyint(value / unit) * unit + 0.0 : value;
}
Vec3 rounded(const Vec3& v, double unit) noexcept {
    return {rounded(v.x, unit), rounded(v.y, unit), rounded(v.z, unit)};
}

/// Rounded, and then of unit length but for the last bits.
Vec3 rounded_direction(const Vec3& v) noexcept {
    return normalized(rounded(v, kResolution));
}

/// The largest component positive; of components that are equal but for rounding the first counts.
Vec3 with_positive_largest(const Vec3& v) noexcept {
    const double largest = max_abs(v) * (1.0 - 1e-6);
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(v[axis]) >= largest) {
            return v[axis] < 0.0 ? -v : v;
        }
    }
    return v;
}

/// The largest coordinate difference of the corners.
double extent_of(const MeshView& mesh, std::span<const TriangleId> triangles) noexcept {
    Vec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const TriangleId id : triangles) {
        for (const Vec3& corner : corners(mesh, id)) {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    }
    return max_abs(high - low);
}

Vec3 area_vector(const Corners& corners) noexcept {
    return 0.5 * glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
}

/// Weight, mean and second central moments.
struct Moments {
    double weight = 0.0;
    Vec3 mean{0.0};
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Of the area, or, if `of_corners`, of the corners with equal weights. Sums are taken relative to
/// the first corner, in the order of the triangles.
Moments moments_of(const MeshView& mesh,
                   std::span<const TriangleId> triangles,
                   bool of_corners) noexcept {
    const Vec3 origin = mesh.positions[mesh.triangles[triangles.front()][0]];
    Moments moments;
    Vec3 first(0.0);
    double second[3][3] = {};
    for (const TriangleId id : triangles) {
        Corners at = corners(mesh, id);
        const Vec3 normal = area_vector(at);
        const double weight = of_corners ? 1.0 : std::sqrt(glm::dot(normal, normal));
        for (Vec3& corner : at) {
            corner -= origin;
        }
        const Vec3 sum = at[0] + at[1] + at[2];
        moments.weight += weight;
        first += weight / 3.0 * sum;
        // The integral of x x^T over a triangle is area / 12 (sum of v v^T + s s^T), s the sum of
        // the corners v; over the corners alone, sum of v v^T / 3.
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k) {
                const double of_vertices =
                    at[0][i] * at[0][k] + at[1][i] * at[1][k] + at[2][i] * at[2][k];
                second[i][k] += of_corners ? weight / 3.0 * of_vertices
                                           : weight / 12.0 * (of_vertices + sum[i] * sum[k]);
            }
        }
    }
    if (moments.weight > 0.0) {
        const Vec3 mean = first / moments.weight;
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k) {
                moments.covariance(i, k) = second[i][k] / moments.weight - mean[i] * mean[k];
            }
        }
        moments.mean = origin + mean;
    }
    return moments;
}

/// The box along three perpendicular directions, its axes by descending size.
OrientedBox box_along(const std::array<Vec3, 3>& directions,
                      const MeshView& mesh,
                      std::span<const TriangleId> triangles) noexcept {
    const Vec3 origin = mesh.positions[mesh.triangles[triangles.front()][0]];
    Vec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const TriangleId id : triangles) {
        for (const Vec3& corner : corners(mesh, id)) {
            for (int k = 0; k < 3; ++k) {
                const double at =
                    glm::dot(corner - origin, directions[static_cast<std::size_t>(k)]);
                low[k] = std::min(low[k], at);
                high[k] = std::max(high[k], at);
            }
        }
    }
    std::array<int, 3> order = {0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return high[a] - low[a] > high[b] - low[b];
    });
    OrientedBox box{.centre = origin, .axes = {}, .half_size = Vec3(0.0)};
    for (int k = 0; k < 3; ++k) {
        const int from = order[static_cast<std::size_t>(k)];
        const Vec3& direction = directions[static_cast<std::size_t>(from)];
        box.axes[static_cast<std::size_t>(k)] = direction;
        box.half_size[k] = (high[from] - low[from]) / 2.0;
        box.centre += direction * ((high[from] + low[from]) / 2.0);
    }
    return box;
}

/// The directions that the surface faces, opposite ones taken together, largest area first. Normals
/// in one cell of a grid are one direction; where rounding parts equal ones, the area is parted
/// too.
std::vector<Vec3> facing_directions(const MeshView& mesh, std::span<const TriangleId> triangles) {
    struct Direction {
        double area = 0.0;
        Vec3 normal{0.0};  // of the first triangle, unit
    };
    std::map<std::array<std::int64_t, 3>, Direction> cells;
    for (const TriangleId id : triangles) {
        const Vec3 vector = area_vector(corners(mesh, id));
        const double area = std::sqrt(glm::dot(vector, vector));
        if (!(area > 0.0)) {
            continue;
        }
        const Vec3 normal = with_positive_largest(vector / area);
        Direction& direction = cells[{std::llround(normal.x / kDirectionCell),
                                      std::llround(normal.y / kDirectionCell),
                                      std::llround(normal.z / kDirectionCell)}];
        direction.normal = direction.area > 0.0 ? direction.normal : normal;
        direction.area += area;
    }
    std::vector<Direction> directions;
    for (const auto& [cell, direction] : cells) {
        directions.push_back(direction);
    }
    std::stable_sort(directions.begin(),
                     directions.end(),
                     [](const Direction& a, const Direction& b) { return a.area > b.area; });
    std::vector<Vec3> result;
    for (std::size_t i = 0; i < std::min(directions.size(), kMaxDirections); ++i) {
        result.push_back(directions[i].normal);
    }
    return result;
}

double half_surface(const OrientedBox& box) noexcept {
    const Vec3& s = box.half_size;
    return s.x * s.y + s.y * s.z + s.z * s.x;
}

/// Smaller by more than rounding, so that candidates that are the same box do not compete.
bool is_smaller(const OrientedBox& a, const OrientedBox& b, double extent) noexcept {
    constexpr double kRounding = 1e-9;
    const double volume = kRounding * extent * extent * extent;
    if (std::abs(a.volume() - b.volume()) > volume) {
        return a.volume() < b.volume();
    }
    return half_surface(a) < half_surface(b) - kRounding * extent * extent;
}

}  // namespace

PrincipalAxes fit_axes(const MeshView& mesh, std::span<const TriangleId> triangles) {
    EARSHOT_ASSERT(!triangles.empty());
    const double unit = kResolution * extent_of(mesh, triangles);
    Moments moments = moments_of(mesh, triangles, false);
    PrincipalAxes result{
        .centroid = {}, .area = moments.weight, .axes = {}, .deviations = Vec3(0.0)};
    if (!(moments.weight > 0.0)) {
        moments = moments_of(mesh, triangles, true);
    }
    result.centroid = rounded(moments.mean, unit);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance);
    for (int k = 0; k < 3; ++k) {
        const int column = 2 - k;  // eigenvalues ascend
        const auto vector = solver.eigenvectors().col(column);
        result.axes[static_cast<std::size_t>(k)] =
            with_positive_largest(rounded_direction({vector(0), vector(1), vector(2)}));
        result.deviations[k] =
            rounded(std::sqrt(std::max(0.0, solver.eigenvalues()(column))), unit);
    }
    result.axes[2] = rounded_direction(glm::cross(result.axes[0], result.axes[1]));
    return result;
}

PlaneFit fit_plane(const MeshView& mesh, std::span<const TriangleId> triangles) {
    const PrincipalAxes axes = fit_axes(mesh, triangles);
    const double extent = extent_of(mesh, triangles);
    Vec3 facing(0.0);
    for (const TriangleId id : triangles) {
        facing += area_vector(corners(mesh, id));
    }
    // Sides are equal where what remains of the areas is their rounding.
    const double sign = glm::dot(facing, axes.axes[2]);
    PlaneFit fit;
    fit.plane.normal = std::abs(sign) > 1e-9 * axes.area
                           ? (sign < 0.0 ? -axes.axes[2] : axes.axes[2])
                           : with_positive_largest(axes.axes[2]);
    fit.plane.offset = glm::dot(fit.plane.normal, axes.centroid);
    fit.rms_distance = axes.deviations.z;
    for (const TriangleId id : triangles) {
        for (const Vec3& corner : corners(mesh, id)) {
            fit.max_distance = std::max(
                fit.max_distance, std::abs(glm::dot(fit.plane.normal, corner - axes.centroid)));
        }
    }
    fit.max_distance = rounded(fit.max_distance, kResolution * extent);
    return fit;
}

OrientedBox fit_box(const MeshView& mesh, std::span<const TriangleId> triangles) {
    EARSHOT_ASSERT(!triangles.empty());
    const double extent = extent_of(mesh, triangles);
    const double unit = kResolution * extent;
    std::vector<std::array<Vec3, 3>> frames = {
        {Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0)},
        fit_axes(mesh, triangles).axes};
    const std::vector<Vec3> directions = facing_directions(mesh, triangles);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        for (std::size_t k = 0; k < directions.size(); ++k) {
            // Gram and Schmidt: the second direction made perpendicular to the first.
            const Vec3 first = rounded_direction(directions[i]);
            const Vec3 rest = directions[k] - first * glm::dot(directions[k], first);
            if (k != i && glm::dot(rest, rest) > 1e-6) {
                const Vec3 second = rounded_direction(normalized(rest));
                frames.push_back({first, second, normalized(glm::cross(first, second))});
            }
        }
    }
    OrientedBox best = box_along(frames.front(), mesh, triangles);
    for (const std::array<Vec3, 3>& frame : frames) {
        const OrientedBox box = box_along(frame, mesh, triangles);
        if (is_smaller(box, best, extent)) {
            best = box;
        }
    }
    best.centre = rounded(best.centre, unit);
    best.half_size = rounded(best.half_size, unit);
    best.axes[0] = with_positive_largest(best.axes[0]);
    best.axes[1] = with_positive_largest(best.axes[1]);
    best.axes[2] = normalized(glm::cross(best.axes[0], best.axes[1]));
    return best;
}

}  // namespace earshot::geometry
