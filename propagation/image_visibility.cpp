// SPDX-License-Identifier: MIT
// From which points near a receiver an image of a sound source is visible.
#include "earshot/base/random.h"
#include "earshot/propagation/internal/ray_tracer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace earshot::propagation {

using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

/// Images of one point in triangles of one plane differ by less than this, metres: far above
/// rounding and far below what changes a sound field.
constexpr double kMaxImageDistance = 1e-6;
/// Relative, of the walls of a rectangular room.
constexpr double kRounding = 1e-9;

Vec3 mirrored(const Vec3& point, const Vec3& plane_point, const Vec3& normal) {
    return point - 2.0 * glm::dot(point - plane_point, normal) * normal;
}

}  // namespace

Vec3 RayTracer::image_in(TriangleId triangle, const Vec3& point) const {
    return mirrored(point, scene_.bvh.corners(triangle)[0], triangle_surfaces_[triangle].normal);
}

/// Whether two triangles mirror a point alike: of one plane, with the same energy.
bool RayTracer::is_same_mirror(const ImageChain& chain,
                               TriangleId one,
                               TriangleId other,
                               const Vec3& image,
                               const Vec3& direction) const {
    if (one == other) {
        return true;
    }
    const auto surface_of = [&](TriangleId triangle) -> const RaySurface& {
        const TriangleSurface& surface = triangle_surfaces_[triangle];
        const bool is_back = glm::dot(surface.normal, direction) > 0.0;
        return chain.surfaces[surface.front + (is_back ? 1 : 0)];
    };
    const Vec3 apart = image_in(one, image) - image_in(other, image);
    return glm::dot(apart, apart) <= kMaxImageDistance * kMaxImageDistance &&
           surface_of(one).specular == surface_of(other).specular;
}

bool RayTracer::is_visible(const ImageChain& chain, const Vec3& from) const {
    Vec3 point = from;
    Vec3 image = chain.image;
    for (std::size_t i = chain.mirrors.size(); i-- > 0;) {
        const double distance = glm::length(image - point);
        const Ray ray = {point, (image - point) / distance};
        const auto hit = scene_.bvh.closest_hit(ray);
        if (!hit || !(hit->t < distance) ||
            !is_same_mirror(chain, hit->triangle, chain.mirrors[i], image, ray.direction)) {
            return false;
        }
        const Vec3& normal = triangle_surfaces_[hit->triangle].normal;
        const double side = glm::dot(normal, ray.direction) > 0.0 ? -1.0 : 1.0;
        point += hit->t * ray.direction + side * self_intersection_offset_ * normal;
        image = image_in(chain.mirrors[i], image);
    }
    return !scene_.bvh.occluded({point, image});
}

// The energy density in the part K of the ball that is visible from the receiver has the expected
// value of the image's times the share of K that sees the image. The number of random points of K
// that it takes until one sees the image has the mean 1 / share: the product is unbiased.
double RayTracer::image_weight(const Receiver& receiver,
                               const ImageChain& chain,
                               std::uint64_t random_key) const {
    constexpr std::uint64_t kMaxTrials = 1024;
    if (!is_visible(chain, receiver.position)) {
        return 0.0;
    }
    for (std::uint64_t trial = 1; trial < kMaxTrials; ++trial) {
        const std::uint64_t bits = random_bits(random_key, 0, trial);
        if (is_visible(chain, receiver.ball_points[bits % receiver.ball_points.size()])) {
            return static_cast<double>(trial);
        }
    }
    return static_cast<double>(kMaxTrials);
}

// Random points of the ball that are visible from its centre.
std::vector<Vec3> RayTracer::draw_ball_points(const Vec3& centre) const {
    constexpr std::uint64_t kPoints = 1024;
    constexpr std::uint64_t kMaxTrials = 256 * kPoints;
    std::vector<Vec3> points;
    const auto number = [&](std::uint64_t trial, std::uint64_t part) {
        return random(options_.seed, kBallStream, 4 * trial + part);
    };
    for (std::uint64_t trial = 0; trial < kMaxTrials && points.size() < kPoints; ++trial) {
        // Evenly in the cube about the ball.
        const Vec3 offset(2.0 * number(trial, 0) - 1.0,
                          2.0 * number(trial, 1) - 1.0,
                          2.0 * number(trial, 2) - 1.0);
        const Vec3 point = centre + options_.receiver_radius * offset;
        if (glm::dot(offset, offset) < 1.0 && !scene_.bvh.occluded({point, centre})) {
            points.push_back(point);
        }
    }
    return points;
}

/// Whether every triangle is a part of a wall, and walls are whole and of one material.
bool RayTracer::has_whole_walls(const RectangularRoom& room,
                                std::span<const std::size_t> axis_of_triangle) const {
    const geometry::MeshView& mesh = scene_.mesh();
    double areas[3][2] = {};
    std::optional<std::uint32_t> materials[3][2];
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = geometry::corners(mesh, i);
        const std::size_t axis = axis_of_triangle[i];
        const double extent = room.high[axis] - room.low[axis];
        const double position = glm::dot(room.axes[axis], a);
        const std::size_t side = position > 0.5 * (room.low[axis] + room.high[axis]) ? 1 : 0;
        const double wall = side == 1 ? room.high[axis] : room.low[axis];
        auto& material = materials[axis][side];
        if (std::abs(position - wall) > kRounding * extent ||
            (material && *material != scene_.material_of_triangle[i])) {
            return false;
        }
        material = scene_.material_of_triangle[i];
        areas[axis][side] += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double area = (room.high[u] - room.low[u]) * (room.high[v] - room.low[v]);
        for (const double found : areas[axis]) {
            if (std::abs(found - area) > kRounding * area) {
                return false;
            }
        }
    }
    return true;
}

/// The room, if it is rectangular and has one material per wall: there, every image that a listener
/// sees is visible from all of the room, by one order of its mirrors or another.
std::optional<RectangularRoom> RayTracer::find_rectangular_room() const {
    const geometry::MeshView& mesh = scene_.mesh();
    // Axes: the normals.
    std::vector<Vec3> axes;
    std::vector<std::size_t> axis_of_triangle;
    for (const TriangleSurface& triangle : triangle_surfaces_) {
        const auto parallel = std::find_if(axes.begin(), axes.end(), [&](const Vec3& axis) {
            return std::abs(glm::dot(axis, triangle.normal)) > 1.0 - kRounding;
        });
        axis_of_triangle.push_back(static_cast<std::size_t>(parallel - axes.begin()));
        if (parallel == axes.end()) {
            if (axes.size() == 3 || std::any_of(axes.begin(), axes.end(), [&](const Vec3& axis) {
                    return std::abs(glm::dot(axis, triangle.normal)) > kRounding;
                })) {
                return std::nullopt;
            }
            axes.push_back(triangle.normal);
        }
    }
    if (axes.size() != 3) {
        return std::nullopt;
    }
    RectangularRoom room;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        room.axes[axis] = axes[axis];
        for (const geometry::Triangle& triangle : mesh.triangles) {
            for (const geometry::VertexId vertex : triangle) {
                const double position = glm::dot(axes[axis], mesh.positions[vertex]);
                room.low[axis] = std::min(room.low[axis], position);
                room.high[axis] = std::max(room.high[axis], position);
            }
        }
    }
    if (!has_whole_walls(room, axis_of_triangle)) {
        return std::nullopt;
    }
    return room;
}

bool RectangularRoom::contains(const Vec3& point) const noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double position = glm::dot(axes[axis], point);
        if (!(position > low[axis] && position < high[axis])) {
            return false;
        }
    }
    return true;
}

}  // namespace earshot::propagation
