// SPDX-License-Identifier: MIT
#include "support/random_rooms.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "support/dice.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace earshot::support {

using geometry::Vec3;

namespace {

constexpr double kMillimetre = 1e-3;
constexpr std::uint32_t kObstacleLabel = 20;
constexpr std::uint32_t kSheetLabel = 40;

Room shell(std::string kind, const Vec3& size) {
    Room room = box_room(Vec3{0.0}, size);
    room.kind = std::move(kind);
    return room;
}

Vec3 random_size(Dice& dice) {
    return {dice.between(3.0, 9.0), dice.between(2.4, 4.5), dice.between(3.0, 8.0)};
}

// Turns by any angle about any axis (Rodrigues), built from a random unit quaternion.
glm::dmat3 random_turn(Dice& dice) {
    glm::dvec4 q{0.0};
    do {
        q = {dice.between(-1.0, 1.0),
             dice.between(-1.0, 1.0),
             dice.between(-1.0, 1.0),
             dice.between(-1.0, 1.0)};
    } while (glm::length(q) > 1.0 || glm::length(q) < 0.1);
    q /= glm::length(q);
    const double x = q.x, y = q.y, z = q.z, w = q.w;
    return {{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)},
            {2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)},
            {2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)}};
}

Hexahedron turned(Hexahedron corners, const glm::dmat3& turn, const Vec3& about) {
    for (Vec3& corner : corners) {
        corner = about + turn * (corner - about);
    }
    return corners;
}

Vec3 random_point(Dice& dice, const Vec3& size, double from_walls) {
    return {dice.between(from_walls, size.x - from_walls),
            dice.between(from_walls, size.y - from_walls),
            dice.between(from_walls, size.z - from_walls)};
}

void add_floating(Room& room, Dice& dice, const Vec3& size) {
    const Vec3 half = {dice.between(0.1, 0.5), dice.between(0.1, 0.5), dice.between(0.1, 0.5)};
    const Vec3 centre = random_point(dice, size, 0.9);
    Hexahedron corners = box_corners(centre - half, centre + half);
    if (dice.chance(0.6)) {
        corners = turned(corners, random_turn(dice), centre);
    }
    add_hexahedron(room, corners, Facing::outward, kObstacleLabel);
}

void add_standing(Room& room, Dice& dice, const Vec3& size) {
    const double half_x = dice.between(0.1, 0.5);
    const double half_z = dice.between(0.1, 0.5);
    const double height = dice.between(0.3, 0.8 * size.y);
    const double x = dice.between(0.8, size.x - 0.8);
    const double z = dice.between(0.8, size.z - 0.8);
    add_hexahedron(room,
                   box_corners({x - half_x, 0.0, z - half_z}, {x + half_x, height, z + half_z}),
                   Facing::outward,
                   kObstacleLabel);
}

void add_obstacles(Room& room, Dice& dice, const Vec3& size, int count) {
    for (int i = 0; i < count; ++i) {
        if (dice.chance(0.5)) {
            add_standing(room, dice, size);
        } else {
            add_floating(room, dice, size);
        }
    }
}

Room obstacle_room(Dice& dice) {
    const Vec3 size = random_size(dice);
    Room room = shell("box with obstacles", size);
    add_obstacles(room, dice, size, 1 + dice.below(4));
    return room;
}

// L, T and U plans with random arms.
Room letter_room(Dice& dice) {
    const double a = dice.between(1.5, 3.5);
    const double b = dice.between(1.5, 3.5);
    const double c = dice.between(1.5, 3.5);
    const double d = dice.between(1.5, 3.5);
    const double e = dice.between(1.5, 3.5);
    const std::array<std::vector<glm::dvec2>, 3> plans = {{
        {{0.0, 0.0}, {a + b, 0.0}, {a + b, d}, {a, d}, {a, d + e}, {0.0, d + e}},
        {{a, 0.0},
         {a + b, 0.0},
         {a + b, d},
         {a + b + c, d},
         {a + b + c, d + e},
         {0.0, d + e},
         {0.0, d},
         {a, d}},
        {{0.0, 0.0},
         {a + b + c, 0.0},
         {a + b + c, d + e},
         {a + b, d + e},
         {a + b, d},
         {a, d},
         {a, d + e},
         {0.0, d + e}},
    }};
    const auto letter = static_cast<std::size_t>(dice.below(3));
    Room room = plan_room(plans[letter], dice.between(2.4, 4.0));
    room.kind = std::string("plan of the letter ") + "LTU"[letter];
    return room;
}

double random_opening(Dice& dice) {
    return dice.chance(0.3) ? kMillimetre : dice.between(0.05, 1.5);
}

// Two halls joined by a passage through a thick wall, from floor to ceiling.
Room passage_room(Dice& dice) {
    const double a = dice.between(2.5, 5.0);
    const double b = a + dice.between(0.1, 0.4);
    const double c = b + dice.between(2.5, 5.0);
    const double depth = dice.between(3.0, 5.0);
    const double low = dice.between(0.5, 1.2);
    const double high = low + random_opening(dice);
    const std::vector<glm::dvec2> plan = {{0.0, 0.0},
                                          {a, 0.0},
                                          {a, low},
                                          {b, low},
                                          {b, 0.0},
                                          {c, 0.0},
                                          {c, depth},
                                          {b, depth},
                                          {b, high},
                                          {a, high},
                                          {a, depth},
                                          {0.0, depth}};
    const double height = dice.between(2.4, 3.5);
    Room room = plan_room(plan, height);
    room.kind = "rooms coupled by a passage";
    room.openings = {from_z_up(0.5 * (a + b), 0.5 * (low + high), 0.5 * height)};
    return room;
}

void add_upright_sheet(Room& room, double x, const glm::dvec2& low, const glm::dvec2& high) {
    const std::array<Vec3, 4> ring = {Vec3{x, low.x, low.y},
                                      Vec3{x, high.x, low.y},
                                      Vec3{x, high.x, high.y},
                                      Vec3{x, low.x, high.y}};
    add_polygon(room, ring, kSheetLabel, true);
}

// A box with a partition of one sheet and a window in it.
Room partition_room(Dice& dice) {
    const Vec3 size = random_size(dice);
    Room room = shell("rooms coupled by a window", size);
    const double x = dice.between(0.3, 0.7) * size.x;
    const double y0 = dice.between(0.0, 0.3) * size.y;
    const double z0 = dice.between(0.1, 0.4) * size.z;
    const double y1 = y0 + std::min(random_opening(dice), 0.6 * size.y);
    const double z1 = z0 + std::min(random_opening(dice), 0.5 * size.z);
    add_upright_sheet(room, x, {0.0, 0.0}, {size.y, z0});
    add_upright_sheet(room, x, {0.0, z1}, {size.y, size.z});
    add_upright_sheet(room, x, {0.0, z0}, {y0, z1});
    add_upright_sheet(room, x, {y1, z0}, {size.y, z1});
    room.openings = {{x, 0.5 * (y0 + y1), 0.5 * (z0 + z1)}};
    return room;
}

// A sloped plane over a rectangle, or four corners at four heights, which fold along a diagonal.
Room sloped_room(Dice& dice) {
    const Vec3 size = random_size(dice);
    Hexahedron corners = box_corners(Vec3{0.0}, size);
    const bool is_folded = dice.chance(0.5);
    const double rise_x = dice.between(-0.8, 0.8);
    const double rise_z = dice.between(-0.8, 0.8);
    for (const std::size_t top : {2U, 3U, 6U, 7U}) {
        const double along_x = (top & 1U) != 0U ? rise_x : 0.0;
        const double along_z = (top & 4U) != 0U ? rise_z : 0.0;
        corners[top].y += is_folded ? dice.between(-0.8, 0.8) : along_x + along_z;
    }
    Room room{.kind = is_folded ? "folded ceiling" : "sloped ceiling"};
    add_hexahedron(room, corners, Facing::inward, 0);
    if (dice.chance(0.5)) {
        add_obstacles(room, dice, {size.x, size.y - 0.8, size.z}, 1 + dice.below(2));
    }
    return room;
}

void add_baffle(Room& room, Dice& dice, const Vec3& size) {
    const Vec3 centre = random_point(dice, size, 1.0);
    const glm::dmat3 turn = random_turn(dice);
    const double half_u = dice.between(0.2, 0.9);
    const double half_v = dice.between(0.2, 0.9);
    if (dice.chance(0.5)) {
        const Vec3 half = {half_u, half_v, 0.5 * kMillimetre};
        const Hexahedron plate = turned(box_corners(centre - half, centre + half), turn, centre);
        add_hexahedron(room, plate, Facing::outward, kObstacleLabel);
        return;
    }
    const Vec3 u = half_u * turn[0];
    const Vec3 v = half_v * turn[1];
    const std::array<Vec3, 4> ring = {
        centre - u - v, centre + u - v, centre + u + v, centre - u + v};
    add_polygon(room, ring, kSheetLabel, true);
}

Room baffle_room(Dice& dice) {
    const Vec3 size = random_size(dice);
    Room room = shell("box with baffles", size);
    const int count = 1 + dice.below(5);
    for (int i = 0; i < count; ++i) {
        add_baffle(room, dice, size);
    }
    return room;
}

// A wall whose triangulation has slivers a tenth of a millimetre wide, a rod a millimetre thick,
// and two plates a millimetre apart.
Room sliver_room(Dice& dice) {
    constexpr double kSliver = 1e-4;
    const Vec3 size = random_size(dice);
    Room room = shell("slivers and gaps", size);
    const double x = dice.between(0.3, 0.6) * size.x;
    const Vec3 a{x, 0.1 * size.y, 0.2 * size.z};
    const Vec3 b{x, 0.8 * size.y, 0.2 * size.z};
    const Vec3 c{x, 0.8 * size.y, 0.7 * size.z};
    const Vec3 d{x, 0.1 * size.y, 0.7 * size.z};
    const Vec3 near_edge{x, dice.between(0.3, 0.6) * size.y, 0.2 * size.z + kSliver};
    for (const auto& triangle : {std::array{a, b, near_edge},
                                 std::array{b, c, near_edge},
                                 std::array{c, d, near_edge},
                                 std::array{d, a, near_edge}}) {
        add_triangle(room, triangle, kSheetLabel, true);
    }
    const Vec3 rod = random_point(dice, size, 0.5);
    const Vec3 half = {0.4, 0.5 * kMillimetre, 0.5 * kMillimetre};
    add_hexahedron(room,
                   turned(box_corners(rod - half, rod + half), random_turn(dice), rod),
                   Facing::outward,
                   kObstacleLabel);
    const double gap_at = dice.between(0.65, 0.9) * size.x;
    const double gap_z = dice.between(0.3, 0.7) * size.z;
    add_upright_sheet(room, gap_at, {0.0, 0.0}, {size.y, gap_z});
    add_upright_sheet(room, gap_at, {0.0, gap_z + kMillimetre}, {size.y, size.z});
    room.openings = {{gap_at, 0.4 * size.y, gap_z + 0.5 * kMillimetre}};
    return room;
}

// Desks in rows, as many as 400 triangles allow.
Room crowded_room(Dice& dice) {
    const Vec3 size = {dice.between(6.0, 9.0), dice.between(2.8, 4.0), dice.between(6.0, 8.0)};
    Room room = shell("crowded box", size);
    const int rows = 3 + dice.below(3);
    const int columns = 3 + dice.below(4);
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const double x = size.x * (i + 0.5) / rows + dice.between(-0.1, 0.1);
            const double z = size.z * (j + 0.5) / columns + dice.between(-0.1, 0.1);
            const double top = dice.between(0.6, 1.2);
            const double bottom = dice.chance(0.5) ? 0.0 : top - 0.03;
            add_hexahedron(room,
                           box_corners({x - 0.35, bottom, z - 0.3}, {x + 0.35, top, z + 0.3}),
                           Facing::outward,
                           kObstacleLabel);
        }
    }
    return room;
}

}  // namespace

Room random_room(std::uint64_t seed) {
    using Family = Room (*)(Dice&);
    constexpr std::array<Family, kRoomFamilies> kFamilies = {
        obstacle_room,
        letter_room,
        [](Dice& dice) { return dice.chance(0.5) ? passage_room(dice) : partition_room(dice); },
        sloped_room,
        baffle_room,
        sliver_room,
        crowded_room};
    Dice dice(seed);
    Room room = kFamilies[seed % kRoomFamilies](dice);
    if (seed / kRoomFamilies % 2 == 1) {
        const glm::dmat3 turn = random_turn(dice);
        for (Vec3& position : room.mesh.positions) {
            position = turn * position;
        }
        for (Vec3& opening : room.openings) {
            opening = turn * opening;
        }
        room.kind += ", turned";
    }
    return room;
}

}  // namespace earshot::support
