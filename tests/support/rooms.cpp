// SPDX-License-Identifier: MIT
#include "support/rooms.h"

#include <algorithm>
#include <utility>

namespace earshot::support {

using geometry::Vec3;
using geometry::VertexId;

namespace {

// Faces of a hexahedron, counter-clockwise seen from outside, in the order of their labels.
constexpr std::array<std::array<std::size_t, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

VertexId vertex_at(geometry::Mesh& mesh, const Vec3& position) {
    auto& positions = mesh.positions;
    const auto found = std::find(positions.begin(), positions.end(), position);
    const auto index = static_cast<VertexId>(found - positions.begin());
    if (found == positions.end()) {
        positions.push_back(position);
    }
    return index;
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_ear(std::span<const glm::dvec2> plan, const std::vector<std::size_t>& left, std::size_t i) {
    const std::size_t n = left.size();
    const std::array<std::size_t, 3> ear = {left[(i + n - 1) % n], left[i], left[(i + 1) % n]};
    if (turn(plan[ear[0]], plan[ear[1]], plan[ear[2]]) <= 0.0) {
        return false;
    }
    return std::none_of(left.begin(), left.end(), [&](std::size_t other) {
        if (std::find(ear.begin(), ear.end(), other) != ear.end()) {
            return false;
        }
        return turn(plan[ear[0]], plan[ear[1]], plan[other]) >= 0.0 &&
               turn(plan[ear[1]], plan[ear[2]], plan[other]) >= 0.0 &&
               turn(plan[ear[2]], plan[ear[0]], plan[other]) >= 0.0;
    });
}

// Ear clipping: fine for plans of a dozen vertices.
std::vector<std::array<std::size_t, 3>> triangulate(std::span<const glm::dvec2> plan) {
    std::vector<std::size_t> left(plan.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
        left[i] = i;
    }
    std::vector<std::array<std::size_t, 3>> ears;
    while (left.size() > 2) {
        std::size_t i = 0;
        while (i + 1 < left.size() && !is_ear(plan, left, i)) {
            ++i;
        }
        const std::size_t n = left.size();
        ears.push_back({left[(i + n - 1) % n], left[i], left[(i + 1) % n]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return ears;
}

// The positions of `divisions` equal steps from low to high, the ends to the last bit.
std::vector<double> steps(double low, double high, int divisions) {
    std::vector<double> result;
    result.reserve(static_cast<std::size_t>(divisions) + 1);
    for (int i = 0; i < divisions; ++i) {
        result.push_back(low + (high - low) * i / divisions);
    }
    result.push_back(high);
    return result;
}

}  // namespace

Hexahedron box_corners(const Vec3& lower, const Vec3& upper) {
    Hexahedron corners{};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        corners[i] = {(i & 1U) != 0U ? upper.x : lower.x,
                      (i & 2U) != 0U ? upper.y : lower.y,
                      (i & 4U) != 0U ? upper.z : lower.z};
    }
    return corners;
}

void add_triangle(Room& room,
                  const std::array<Vec3, 3>& corners,
                  std::uint32_t label,
                  bool is_sheet) {
    room.mesh.triangles.push_back({vertex_at(room.mesh, corners[0]),
                                   vertex_at(room.mesh, corners[1]),
                                   vertex_at(room.mesh, corners[2])});
    room.labels.push_back(label);
    room.is_sheet.push_back(is_sheet ? 1 : 0);
}

void add_polygon(Room& room, std::span<const Vec3> ring, std::uint32_t label, bool is_sheet) {
    for (std::size_t i = 2; i < ring.size(); ++i) {
        add_triangle(room, {ring[0], ring[i - 1], ring[i]}, label, is_sheet);
    }
}

void add_hexahedron(Room& room,
                    const Hexahedron& corners,
                    Facing facing,
                    std::uint32_t first_label) {
    std::uint32_t label = first_label;
    for (const auto& face : kFaces) {
        std::array<Vec3, 4> ring = {
            corners[face[0]], corners[face[1]], corners[face[2]], corners[face[3]]};
        if (facing == Facing::inward) {
            std::swap(ring[1], ring[3]);
        }
        add_polygon(room, ring, label++);
    }
}

Room box_room(const Vec3& lower, const Vec3& upper) {
    Room room{.kind = "box"};
    add_hexahedron(room, box_corners(lower, upper), Facing::inward, 0);
    return room;
}

Room tessellated_box_room(const Vec3& lower, const Vec3& upper, int divisions) {
    Room room{.kind = "tessellated box"};
    std::array<std::vector<double>, 3> grid;
    for (int axis = 0; axis < 3; ++axis) {
        grid[static_cast<std::size_t>(axis)] = steps(lower[axis], upper[axis], divisions);
    }
    const auto last = static_cast<std::size_t>(divisions);
    for (std::uint32_t label = 0; label < 6; ++label) {
        const std::size_t normal = label / 2;
        const std::size_t first = (normal + 1) % 3;
        const std::size_t second = (normal + 2) % 3;
        for (std::size_t i = 0; i < last; ++i) {
            for (std::size_t j = 0; j < last; ++j) {
                const auto corner = [&](std::size_t di, std::size_t dj) {
                    std::array<double, 3> at{};
                    at[normal] = grid[normal][label % 2 == 0 ? 0 : last];
                    at[first] = grid[first][i + di];
                    at[second] = grid[second][j + dj];
                    return Vec3{at[0], at[1], at[2]};
                };
                std::array<Vec3, 4> ring = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
                if (label % 2 == 1) {
                    std::swap(ring[1], ring[3]);
                }
                add_polygon(room, ring, label);
            }
        }
    }
    return room;
}

Vec3 from_z_up(double x, double y, double z) {
    return {x, z, -y};
}

Room plan_room(std::span<const glm::dvec2> plan, double height) {
    Room room{.kind = "plan"};
    const auto count = static_cast<std::uint32_t>(plan.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::dvec2& a = plan[i];
        const glm::dvec2& b = plan[(i + 1) % count];
        const std::array<Vec3, 4> wall = {from_z_up(a.x, a.y, 0.0),
                                          from_z_up(a.x, a.y, height),
                                          from_z_up(b.x, b.y, height),
                                          from_z_up(b.x, b.y, 0.0)};
        add_polygon(room, wall, i);
    }
    for (const auto& [i, j, k] : triangulate(plan)) {
        const glm::dvec2 &a = plan[i], &b = plan[j], &c = plan[k];
        add_triangle(room,
                     {from_z_up(a.x, a.y, 0.0), from_z_up(b.x, b.y, 0.0), from_z_up(c.x, c.y, 0.0)},
                     count);
        add_triangle(
            room,
            {from_z_up(a.x, a.y, height), from_z_up(c.x, c.y, height), from_z_up(b.x, b.y, height)},
            count + 1);
    }
    return room;
}

Room reference_box() {
    const std::vector<glm::dvec2> plan = {{0.0, 0.0}, {8.0, 0.0}, {8.0, 6.0}, {0.0, 6.0}};
    return plan_room(plan, 3.5);
}

Room reference_l_room() {
    const std::vector<glm::dvec2> plan = {
        {0.0, 0.0}, {6.0, 0.0}, {6.0, 3.0}, {3.0, 3.0}, {3.0, 6.0}, {0.0, 6.0}};
    return plan_room(plan, 3.0);
}

}  // namespace earshot::support
