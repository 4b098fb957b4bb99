// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace earshot::support {

/// A room for tests: triangles with a label each (what a scene would call its material). Walls face
/// the air: a shell inward, an obstacle outward. Vertices at equal positions are one vertex.
struct Room {
    std::string kind{};  ///< what it is, for messages
    geometry::Mesh mesh{};
    std::vector<std::uint32_t> labels{};  ///< per triangle
    /// Per triangle: 1 if it belongs to a single sheet, 0 if to a closed surface.
    std::vector<std::uint8_t> is_sheet{};
    /// Points inside openings so narrow that random sound would hardly find them.
    std::vector<geometry::Vec3> openings{};
};

enum class Facing { inward, outward };

/// Corners of a box, bent or turned as you like: bit 0, 1, 2 of the index chooses the upper end of
/// the first, second, third edge direction, which run like x, y, z of a right-handed frame.
using Hexahedron = std::array<geometry::Vec3, 8>;

Hexahedron box_corners(const geometry::Vec3& lower, const geometry::Vec3& upper);

void add_triangle(Room& room,
                  const std::array<geometry::Vec3, 3>& corners,
                  std::uint32_t label,
                  bool is_sheet = false);

/// A convex polygon as a fan of triangles; its front is where it runs counter-clockwise.
void add_polygon(Room& room,
                 std::span<const geometry::Vec3> ring,
                 std::uint32_t label,
                 bool is_sheet = false);

/// Six quadrilaterals labelled first_label + 0 ... 5: low and high first, second and third end.
void add_hexahedron(Room& room,
                    const Hexahedron& corners,
                    Facing facing,
                    std::uint32_t first_label);

/// A box as 12 triangles seen from inside; label 2 * axis is its low wall, 2 * axis + 1 its high.
Room box_room(const geometry::Vec3& lower, const geometry::Vec3& upper);

/// The same walls, each divided into divisions^2 cells of two triangles (16: 3,072 triangles). The
/// grid lies exactly on the planes of the box and keeps its corners to the last bit.
Room tessellated_box_room(const geometry::Vec3& lower, const geometry::Vec3& upper, int divisions);

/// A floor plan (x, y), counter-clockwise, drawn up to `height`, in the frame of the library:
/// plan (x, y) at height z stands at (x, z, -y). Label i is the wall from plan vertex i to the
/// next, label n the floor and n + 1 the ceiling, n being the number of plan vertices.
Room plan_room(std::span<const glm::dvec2> plan, double height);

/// A point given with z up (the reference tables' frame) in the frame of the library.
geometry::Vec3 from_z_up(double x, double y, double z);

/// The rooms of tests/data/paths: box 8 x 6 x 3.5, and the L-shaped plan of height 3.
Room reference_box();
Room reference_l_room();

}  // namespace earshot::support
