// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
#include <optional>

namespace earshot::bvh {

/// What to leave out of the bounds.
enum class Omitted {
    none,
    corner,
    depth,
    lateral,
    edge,
    known,
    spread,
    distance,
    plane_pad,
};

/// A ray and a triangle in a scene, and what double precision decides.
struct Encounter {
    geometry::Ray ray;
    geometry::Segment segment;
    geometry::Vec3 corners[3];
    double reach = 0.0;  // no coordinate of the scene is larger
    std::optional<geometry::Hit> hit;
    bool touches = false;
    geometry::Interval box_interval;
};

/// Rays from one point, close to each other, and a triangle.
struct PacketEncounter {
    static constexpr std::size_t kRays = 16;
    std::array<geometry::Ray, kRays> rays;
    geometry::Vec3 corners[3];
    double reach = 0.0;
    std::array<std::optional<geometry::Hit>, kRays> hits;
    std::array<geometry::Interval, kRays> box_intervals;
};

}  // namespace earshot::bvh
