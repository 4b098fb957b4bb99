// SPDX-License-Identifier: MIT
#include "earshot/geometry/track.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>

namespace earshot::geometry {
namespace {

glm::dquat quaternion(const double* xyzw) noexcept {
    return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

double length(const glm::dquat& q) noexcept {
    return std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
}

/// `fallback` where the quaternion has no direction, as between opposite spline keys.
glm::dquat unit_or(const glm::dquat& q, const glm::dquat& fallback) noexcept {
    const double size = length(q);
    return size > 0.0 ? glm::dquat(q.w / size, q.x / size, q.y / size, q.z / size) : fallback;
}

void store(const glm::dquat& q, std::span<double> out) noexcept {
    out[0] = q.x;
    out[1] = q.y;
    out[2] = q.z;
    out[3] = q.w;
}

/// glTF 2.0 appendix C.5: cubic Hermite spline, tangents scaled by the length of the interval.
/// `from` and `to` point at in-tangent, value, out-tangent of the two keys.
void hermite(const double* from,
             const double* to,
             double fraction,
             double interval,
             std::span<double> out) noexcept {
    const double f = fraction;
    const double f2 = f * f;
    const double f3 = f2 * f;
    const std::size_t width = out.size();
    for (std::size_t i = 0; i < width; ++i) {
        out[i] = (2.0 * f3 - 3.0 * f2 + 1.0) * from[width + i] +
                 interval * (f3 - 2.0 * f2 + f) * from[2 * width + i] +
                 (3.0 * f2 - 2.0 * f3) * to[width + i] + interval * (f3 - f2) * to[i];
    }
}

}  // namespace

glm::dmat4 Transform::matrix() const noexcept {
    const glm::dmat3 rotated = glm::mat3_cast(rotation);
    return {glm::dvec4(rotated[0] * scale.x, 0.0),
            glm::dvec4(rotated[1] * scale.y, 0.0),
            glm::dvec4(rotated[2] * scale.z, 0.0),
            glm::dvec4(translation, 1.0)};
}

Vec3 transform_point(const glm::dmat4& m, const Vec3& p) noexcept {
    return {m[0].x * p.x + m[1].x * p.y + m[2].x * p.z + m[3].x,
            m[0].y * p.x + m[1].y * p.y + m[2].y * p.z + m[3].y,
            m[0].z * p.x + m[1].z * p.y + m[2].z * p.z + m[3].z};
}

glm::dquat slerp(const glm::dquat& a, const glm::dquat& b, double fraction) noexcept {
    const double dot = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    const glm::dquat near = dot < 0.0 ? -b : b;
    // Half the angle between two unit vectors has the tangent |a - b| / |a + b|.
    const double angle = 2.0 * math::atan2(length(near - a), length(near + a));
    if (angle == 0.0) {
        return a;
    }
    const double whole = math::sin(angle);
    const double weight_a = math::sin(angle * (1.0 - fraction)) / whole;
    const double weight_b = math::sin(angle * fraction) / whole;
    return unit_or(a * weight_a + near * weight_b, a);
}

void Track::sample(double t, std::span<double> out, bool is_rotation) const {
    EARSHOT_ASSERT(!times.empty() && (!is_rotation || out.size() == 4));
    const std::size_t width = out.size();
    const bool is_cubic = interpolation == Interpolation::cubic_spline;
    const std::size_t stride = is_cubic ? 3 * width : width;
    const std::size_t value = is_cubic ? width : 0;  // where a key's value stands among its numbers
    EARSHOT_ASSERT(values.size() == times.size() * stride);

    // The last key not after t; before the first key, the first.
    const auto after = std::upper_bound(times.begin(), times.end(), t);
    const auto next = static_cast<std::size_t>(after - times.begin());
    const std::size_t key = next == 0 ? 0 : next - 1;
    const double* from = values.data() + key * stride;
    const bool is_held = next == 0 || next == times.size() || interpolation == Interpolation::step;
    if (is_held) {
        std::copy_n(from + value, width, out.begin());
        if (is_rotation) {
            store(unit_or(quaternion(from + value), {1.0, 0.0, 0.0, 0.0}), out);
        }
        return;
    }

    const double* to = from + stride;
    const double interval = times[next] - times[key];
    const double fraction = (t - times[key]) / interval;
    if (is_cubic) {
        hermite(from, to, fraction, interval, out);
        if (is_rotation) {
            store(unit_or(quaternion(out.data()), quaternion(from + value)), out);
        }
    } else if (is_rotation) {
        const glm::dquat identity{1.0, 0.0, 0.0, 0.0};
        store(
            slerp(unit_or(quaternion(from), identity), unit_or(quaternion(to), identity), fraction),
            out);
    } else {
        for (std::size_t i = 0; i < width; ++i) {
            out[i] = (1.0 - fraction) * from[i] + fraction * to[i];
        }
    }
}

}  // namespace earshot::geometry
