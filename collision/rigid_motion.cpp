// SPDX-License-Identifier: MIT
#include "earshot/collision/rigid_motion.h"

#include "earshot/base/math.h"
#include "earshot/collision/broad_phase/internal/relative_pose.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// Rodrigues' formula.
glm::dmat3 rotation_about(const Vec3& axis, double angle) noexcept {
    const double s = math::sin(angle);
    const double half = math::sin(0.5 * angle);
    const double c1 = 2.0 * half * half;  // 1 - cos
    const glm::dmat3 cross(
        0.0, axis.z, -axis.y, -axis.z, 0.0, axis.x, axis.y, -axis.x, 0.0);  // by columns
    return glm::dmat3(1.0) + s * cross + c1 * (cross * cross);
}

/// The axis of a rotation. Close to half a turn, where the antisymmetric part vanishes, it is the
/// longest column of the symmetric part.
Vec3 axis_of(const glm::dmat3& r, const Vec3& twice_sine) {
    const double cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0);
    if (cosine > -0.5) {
        return glm::normalize(twice_sine);
    }
    const glm::dmat3 symmetric = 0.5 * (r + glm::transpose(r)) - cosine * glm::dmat3(1.0);
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
        longest = symmetric[k][k] > symmetric[longest][longest] ? k : longest;
    }
    const Vec3 axis = glm::normalize(symmetric[longest]);
    return glm::dot(axis, twice_sine) < 0.0 ? -axis : axis;
}

double distance_to_axis(const Screw& screw, const Vec3& p) {
    return glm::length(glm::cross(screw.axis, p - screw.point));
}

}  // namespace

Screw Screw::between(const Pose& from, const Pose& to) {
    require_rigid(from);
    require_rigid(to);
    const glm::dmat3 r = to.rotation * glm::transpose(from.rotation);
    const Vec3 shift = to.translation - r * from.translation;
    const Vec3 twice_sine(r[1][2] - r[2][1], r[2][0] - r[0][2], r[0][1] - r[1][0]);
    const double cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0);
    const double angle = math::atan2(0.5 * glm::length(twice_sine), cosine);
    // The axis of a smaller rotation is too far away to be determined.
    if (!(angle > 1e-9)) {
        const double length = glm::length(shift);
        return {.axis = length > 0.0 ? shift / length : Vec3(0.0, 1.0, 0.0), .slide = length};
    }
    Screw screw{.axis = axis_of(r, twice_sine), .angle = angle};
    screw.slide = glm::dot(screw.axis, shift);
    const Vec3 across = shift - screw.slide * screw.axis;
    const double half = 0.5 * angle;
    screw.point =
        0.5 * (across + (math::cos(half) / math::sin(half)) * glm::cross(screw.axis, across));
    return screw;
}

Pose Screw::at(double time) const noexcept {
    const glm::dmat3 rotation = rotation_about(axis, time * angle);
    return {rotation, point - rotation * point + (time * slide) * axis};
}

Vec3 Screw::apply(const Vec3& p, double time) const noexcept {
    // Rodrigues' formula for the displacement of the arm from the axis.
    const double s = math::sin(time * angle);
    const double half = math::sin(0.5 * time * angle);
    const Vec3 tangent = glm::cross(axis, p - point);
    return p +
           (s * tangent + 2.0 * half * half * glm::cross(axis, tangent) + (time * slide) * axis);
}

double Screw::chord_deviation(const Vec3& p) const noexcept {
    return 0.125 * angle * angle * distance_to_axis(*this, p) * (1.0 + 1e-12);
}

Pose RigidMotion::at(double time) const noexcept {
    Pose pose = start;
    for (auto screw = screws.rbegin(); screw != screws.rend(); ++screw) {
        const Pose moved = screw->at(time);
        pose = {moved.rotation * pose.rotation, moved.apply(pose.translation)};
    }
    return pose;
}

double RigidMotion::acceleration_bound(std::span<const Vec3> points) const noexcept {
    if (screws.empty()) {
        return 0.0;
    }
    double to_axis = 0.0;   // the largest distance from the axis of the screw at hand
    double to_point = 0.0;  // and from its point
    for (const Vec3& point : points) {
        const Vec3 placed = start.apply(point);
        to_axis = std::max(to_axis, distance_to_axis(screws.back(), placed));
        to_point = std::max(to_point, glm::length(placed - screws.back().point));
    }
    double speed = 0.0;
    double acceleration = 0.0;
    for (std::size_t i = screws.size(); i-- > 0;) {
        const Screw& screw = screws[i];
        const double rate = std::fabs(screw.angle);
        acceleration += rate * (rate * to_axis + 2.0 * speed);
        speed += rate * to_axis + std::fabs(screw.slide);
        if (i > 0) {
            to_point += std::fabs(screw.slide) + glm::length(screw.point - screws[i - 1].point);
            to_axis = to_point;
        }
    }
    return acceleration * (1.0 + 1e-12);
}

double linear_step_count(double acceleration_bound, double tolerance) noexcept {
    return std::max(1.0, std::ceil(std::sqrt(acceleration_bound / (8.0 * tolerance))));
}

}  // namespace earshot::collision
