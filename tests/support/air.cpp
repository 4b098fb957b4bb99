// SPDX-License-Identifier: MIT
#include "support/air.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace earshot::support {

using geometry::Vec3;

namespace {

// Along no edge or plane of the rooms, which are made of round numbers and random turns.
const Vec3 kParityRay{0.5403023058681398, 0.7071067811865476, -0.3183098861837907};

std::array<Vec3, 3> corners_of(const Room& room, std::size_t i) {
    return geometry::corners(room.mesh, i);
}

// Moeller and Trumbore 1997; the ray is known to avoid edges.
bool meets(const Vec3& origin, const std::array<Vec3, 3>& t) {
    const Vec3 first = t[1] - t[0];
    const Vec3 second = t[2] - t[0];
    const Vec3 p = glm::cross(kParityRay, second);
    const double determinant = glm::dot(first, p);
    if (determinant == 0.0) {
        return false;
    }
    const Vec3 s = origin - t[0];
    const double u = glm::dot(s, p) / determinant;
    const Vec3 q = glm::cross(s, first);
    const double v = glm::dot(kParityRay, q) / determinant;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && glm::dot(second, q) / determinant > 0.0;
}

double point_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 ab = b - a;
    const double t = std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
    return glm::length(p - (a + t * ab));
}

double point_triangle(const Vec3& p, const std::array<Vec3, 3>& t) {
    const Vec3 normal = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    bool is_above = true;
    double closest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& a = t[i];
        const Vec3& b = t[(i + 1) % 3];
        is_above = is_above && glm::dot(glm::cross(b - a, p - a), normal) >= 0.0;
        closest = std::min(closest, point_segment(p, a, b));
    }
    return is_above ? std::abs(glm::dot(p - t[0], normal)) : closest;
}

Vec3 mirrored(const Vec3& point, const std::array<Vec3, 3>& t) {
    const Vec3 normal = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    return point - 2.0 * glm::dot(point - t[0], normal) * normal;
}

Vec3 point_beside_an_edge(const std::array<Vec3, 3>& t, Dice& dice) {
    constexpr double kBeside = 1e-6;
    const auto first = static_cast<std::size_t>(dice.below(3));
    Vec3 point = glm::mix(t[first], t[(first + 1) % 3], dice.between(0.0, 1.0));
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] += dice.between(-kBeside, kBeside);
    }
    return point;
}

}  // namespace

bool is_in_air(const Room& room, const Vec3& point) {
    bool is_odd = false;
    for (std::size_t i = 0; i < room.mesh.triangles.size(); ++i) {
        if (room.is_sheet[i] == 0 && meets(point, corners_of(room, i))) {
            is_odd = !is_odd;
        }
    }
    return is_odd;
}

double distance_to_walls(const Room& room, const Vec3& point) {
    double closest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < room.mesh.triangles.size(); ++i) {
        closest = std::min(closest, point_triangle(point, corners_of(room, i)));
    }
    return closest;
}

Vec3 random_air_point(const Room& room, Dice& dice, double clearance) {
    Vec3 lower{std::numeric_limits<double>::max()};
    Vec3 upper{std::numeric_limits<double>::lowest()};
    for (const Vec3& p : room.mesh.positions) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    for (int attempt = 0; attempt < 1000; ++attempt) {
        Vec3 point{};
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = dice.between(lower[axis], upper[axis]);
        }
        if (is_in_air(room, point) && distance_to_walls(room, point) >= clearance) {
            return point;
        }
    }
    throw std::runtime_error("no air found in room " + room.kind);
}

Vec3 aimed_air_point(const Room& room, const Vec3& source, Dice& dice) {
    const auto any_triangle = [&] {
        const int count = static_cast<int>(room.mesh.triangles.size());
        return corners_of(room, static_cast<std::size_t>(dice.below(count)));
    };
    for (int attempt = 0; attempt < 200; ++attempt) {
        const std::array<Vec3, 3> mirror = any_triangle();
        const bool is_direct = dice.chance(0.3);
        const Vec3 from = is_direct ? source : mirrored(source, mirror);
        Vec3 through = point_beside_an_edge(dice.chance(0.5) ? mirror : any_triangle(), dice);
        if (!room.openings.empty() && dice.chance(0.4)) {
            through = room.openings[static_cast<std::size_t>(
                dice.below(static_cast<int>(room.openings.size())))];
        }
        const Vec3 point = through + dice.between(0.05, 1.0) * (through - from);
        if (is_in_air(room, point) && distance_to_walls(room, point) >= 0.02) {
            return point;
        }
    }
    return random_air_point(room, dice);
}

}  // namespace earshot::support
