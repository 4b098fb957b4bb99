// SPDX-License-Identifier: MIT
#include "earshot/propagation/room_shapes.h"

#include "earshot/base/error.h"
#include "earshot/geometry/predicates.h"
#include "earshot/geometry/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using Plan = std::vector<glm::dvec2>;

constexpr double kMinMeasure = 1e-6, kMaxMeasure = 1e9;  // metres

bool is_measure(double value) {
    return value >= kMinMeasure && value <= kMaxMeasure;
}

/// Numbers that the exact predicates take.
double without_tiny(double coordinate) {
    return std::abs(coordinate) < geometry::kMinCoordinate ? 0.0 : coordinate;
}

/// Whether c, on the line through a and b, lies between them.
bool is_between(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return std::min(a.x, b.x) <= c.x && c.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= c.y &&
           c.y <= std::max(a.y, b.y);
}

/// Whether two closed segments share a point.
bool touch(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
    const int c_side = geometry::orient2d(a, b, c), d_side = geometry::orient2d(a, b, d);
    const int a_side = geometry::orient2d(c, d, a), b_side = geometry::orient2d(c, d, b);
    if (c_side * d_side < 0 && a_side * b_side < 0) {
        return true;
    }
    return (c_side == 0 && is_between(a, b, c)) || (d_side == 0 && is_between(a, b, d)) ||
           (a_side == 0 && is_between(c, d, a)) || (b_side == 0 && is_between(c, d, b));
}

[[noreturn]] void fail_touching(std::size_t a, std::size_t b) {
    throw Error("floor plan",
                "wall " + std::to_string(a) + " touches wall " + std::to_string(b),
                "give the corners of a polygon that does not touch or cross itself");
}

/// Neighbours may share their corner alone, all others nothing.
void require_simple(const Plan& plan) {
    const std::size_t n = plan.size();
    const auto corner = [&](std::size_t i) -> const glm::dvec2& { return plan[i % n]; };
    for (std::size_t i = 0; i < n; ++i) {
        if (corner(i) == corner(i + 1)) {
            throw Error("floor plan",
                        "corners " + std::to_string(i) + " and " + std::to_string((i + 1) % n) +
                            " are one point",
                        "give each corner once");
        }
        const glm::dvec2 &a = corner(i), &b = corner(i + 1), &c = corner(i + 2);
        if (geometry::orient2d(a, b, c) == 0 && (is_between(a, b, c) || is_between(b, c, a))) {
            fail_touching(i, (i + 1) % n);
        }
        for (std::size_t k = i + 2; k < n && (k + 1) % n != i; ++k) {
            if (touch(a, b, corner(k), corner(k + 1))) {
                fail_touching(i, k);
            }
        }
    }
}

/// Of a simple polygon: the corner that is lowest, of several the leftmost, is convex.
bool is_counter_clockwise(const Plan& plan) {
    const auto lowest =
        std::min_element(plan.begin(), plan.end(), [](const glm::dvec2& a, const glm::dvec2& b) {
            return std::pair(a.y, a.x) < std::pair(b.y, b.x);
        });
    const auto i = static_cast<std::size_t>(lowest - plan.begin());
    const std::size_t n = plan.size();
    return geometry::orient2d(plan[(i + n - 1) % n], plan[i], plan[(i + 1) % n]) > 0;
}

Scene room_of(const Plan& seen_from_above, double height, const std::vector<std::string>& names) {
    require_simple(seen_from_above);
    const std::size_t n = seen_from_above.size();
    const auto floor_vertex = [](std::size_t corner) { return static_cast<std::uint32_t>(corner); };
    const auto ceiling_vertex = [n](std::size_t corner) {
        return static_cast<std::uint32_t>(n + corner);
    };
    geometry::Mesh mesh;
    for (const double y : {0.0, height}) {
        for (const glm::dvec2& corner : seen_from_above) {
            mesh.positions.push_back({corner.x, y, corner.y == 0.0 ? 0.0 : -corner.y});
        }
    }
    Scene scene;
    const auto add = [&](const Triangle& triangle, std::size_t material) {
        mesh.triangles.push_back(triangle);
        scene.material_of_triangle.push_back(static_cast<std::uint32_t>(material));
    };
    const bool is_ccw = is_counter_clockwise(seen_from_above);
    geometry::IndexLoop outline(n);
    std::iota(outline.begin(), outline.end(), std::size_t{0});
    if (!is_ccw) {
        std::reverse(outline.begin(), outline.end());
    }
    const auto faces =
        geometry::triangulate(seen_from_above, {outline}, geometry::EarOrder::shortest_diagonal);
    for (const auto& [a, b, c] : faces) {
        add({floor_vertex(a), floor_vertex(b), floor_vertex(c)}, 0);
    }
    for (const auto& [a, b, c] : faces) {
        add({ceiling_vertex(a), ceiling_vertex(c), ceiling_vertex(b)}, 1);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t from = is_ccw ? i : (i + 1) % n;
        const std::size_t to = is_ccw ? (i + 1) % n : i;
        add({floor_vertex(from), ceiling_vertex(from), ceiling_vertex(to)}, i + 2);
        add({floor_vertex(from), ceiling_vertex(to), floor_vertex(to)}, i + 2);
    }
    for (const std::string& name : names) {
        Material material;
        material.name = name;
        material.absorption = EnergyCoefficient(0.1);
        material.scattering = EnergyCoefficient(0.1);
        scene.materials.push_back(std::move(material));
    }
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
    scene.mesh.set_meshes({"room"}, std::vector<std::uint32_t>(scene.material_of_triangle.size()));
    return scene;
}

}  // namespace

Scene shoebox_room(const Vec3& size) {
    for (const double side_length : {size.x, size.y, size.z}) {
        if (!is_measure(side_length)) {
            throw Error("size",
                        "has a side of " + std::to_string(side_length) + " m",
                        "give sides of 1e-6 ... 1e9 m");
        }
    }
    Scene scene = room_of({{0.0, 0.0}, {size.x, 0.0}, {size.x, -size.z}, {0.0, -size.z}},
                          size.y,
                          {"floor", "ceiling", "north", "east", "south", "west"});
    scene.name = "shoebox";
    return scene;
}

Scene extruded_room(std::span<const glm::dvec2> floor_plan, double height) {
    if (!is_measure(height)) {
        throw Error(
            "height", "is " + std::to_string(height) + " m", "give a height of 1e-6 ... 1e9 m");
    }
    if (floor_plan.size() < 3) {
        throw Error("floor plan",
                    "has " + std::to_string(floor_plan.size()) + " corners",
                    "give three or more");
    }
    Plan seen_from_above;
    std::vector<std::string> names = {"floor", "ceiling"};
    for (const glm::dvec2& corner : floor_plan) {
        if (!(std::abs(corner.x) <= kMaxMeasure && std::abs(corner.y) <= kMaxMeasure)) {
            throw Error("floor plan",
                        "corner " + std::to_string(seen_from_above.size()) +
                            " is not finite or beyond 1e9 m",
                        "give corners near the origin");
        }
        names.push_back("wall " + std::to_string(seen_from_above.size()));
        // x to the right, +z downwards.
        seen_from_above.push_back({without_tiny(corner.x), without_tiny(-corner.y)});
    }
    Scene scene = room_of(seen_from_above, height, names);
    scene.name = "room";
    return scene;
}

}  // namespace earshot::propagation
