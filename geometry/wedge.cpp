// SPDX-License-Identifier: MIT
#include "earshot/geometry/wedge.h"

#include "earshot/base/math.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace earshot::geometry {

double Wedge::length() const noexcept {
    return std::sqrt(glm::dot(end - begin, end - begin));
}

WedgePoint wedge_coordinates(const Wedge& wedge, const Vec3& point) noexcept {
    const Vec3 offset = point - wedge.begin;
    const double along_tangent = glm::dot(offset, wedge.tangent);
    const double along_normal = glm::dot(offset, wedge.normal);
    // atan2 keeps all digits near the faces, where acos would lose half of them.
    const double angle = math::atan2(along_normal, along_tangent);
    return {.radius = std::sqrt(along_tangent * along_tangent + along_normal * along_normal),
            .angle = angle < 0.0 ? angle + 2.0 * math::kPi : angle,
            .z = glm::dot(offset, wedge.direction)};
}

Wedge make_wedge(const Vec3& begin, const Vec3& end, const Vec3& in_first_face, double open_angle) {
    Wedge wedge;
    wedge.begin = begin;
    wedge.end = end;
    wedge.direction = normalized(end - begin);
    const Vec3 offset = in_first_face - begin;
    wedge.tangent = normalized(offset - glm::dot(offset, wedge.direction) * wedge.direction);
    wedge.normal = glm::cross(wedge.direction, wedge.tangent);
    wedge.open_angle = open_angle;
    return wedge;
}

}  // namespace earshot::geometry
