// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>

namespace earshot::geometry {

using Vec3 = glm::dvec3;           ///< metres, glTF axes: right-handed, +Y up
using TriangleId = std::uint32_t;  ///< counts over the scene in file order, as in paths.json
using VertexId = std::uint32_t;

struct Ray {
    Vec3 origin{};
    Vec3 direction{0.0, 0.0, -1.0};  ///< any length but 0; distances count in multiples of it
    double t_max = std::numeric_limits<double>::infinity();
};

struct Segment {
    Vec3 from{};
    Vec3 to{};
};

/// An intersection of a ray with a triangle.
struct Hit {
    TriangleId triangle = 0;
    double t = 0.0;           ///< distance from the origin in multiples of the ray's direction
    double u = 0.0, v = 0.0;  ///< weights of the triangle's second and third vertex
    friend bool operator==(const Hit&, const Hit&) = default;
};

}  // namespace earshot::geometry
