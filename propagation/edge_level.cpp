// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/edge_level.h"

#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::propagation {

namespace {

/// Metres from a point to the closest of a part of an edge.
double distance(const geometry::WedgePoint& point, const geometry::Interval& part) noexcept {
    const double beyond = point.z - std::clamp(point.z, part.min, part.max);
    return std::sqrt(point.radius * point.radius + beyond * beyond);
}

}  // namespace

// The integral of Svensson, Fred and Vanderkooy (1999) over z, at most
//   |H| <= (1 / 4 pi) int |B| dz / (m l),  |B| <= max(sum of terms with a > 0, of those with a <
//   0),
// where each term is largest at the apex: nu |cot(a / 2)|. The integral over dz / (m l) is at most
// the part's length over the smallest m and l; that of one term over the whole line is at most
// 2 (pi - |a|) / L. The largest term, which may be close to its boundary, is taken apart.
double max_pressure_between(const geometry::Wedge& wedge,
                            const geometry::Interval& part,
                            const frustum::EdgeEnd& source,
                            const frustum::EdgeEnd& listener,
                            const std::array<double, 3>& face_factors) noexcept {
    const double nu = math::kPi / wedge.open_angle;
    const double difference = source.image.angle - listener.image.angle;
    const double sum = source.image.angle + listener.image.angle;
    const std::array<double, 4> phi{
        math::kPi + difference, math::kPi - difference, math::kPi - sum, math::kPi + sum};
    const std::array<double, 4> factor{
        face_factors[0], face_factors[0], face_factors[1], face_factors[2]};
    std::array<double, 2> of_sign{};
    double largest = 0.0, largest_angle = 0.0, largest_factor = 0.0;
    std::size_t largest_sign = 0;
    constexpr double kMinAngle = 1e-6;  // the signs of smaller ones are those of paths
    for (std::size_t i = 0; i < 4; ++i) {
        const double turns = nu * phi[i] / (2.0 * math::kPi);
        const double a = 2.0 * math::kPi * (turns - std::nearbyint(turns));
        const double angle = std::max(std::abs(a), kMinAngle);
        // cot x <= 1 / x - x / 3 up to pi / 2.
        const double term = factor[i] * nu * (2.0 / angle - angle / 6.0);
        const std::size_t sign = a > 0.0 ? 1 : 0;
        of_sign[sign] += term;
        if (term > largest) {
            largest = term;
            largest_angle = angle;
            largest_factor = factor[i];
            largest_sign = sign;
        }
    }
    const double from_source = distance(source.image, part);
    const double from_listener = distance(listener.image, part);
    const double radii = source.image.radius + listener.image.radius;
    const double rise = source.image.z - listener.image.z;
    const double length =
        std::max(std::sqrt(radii * radii + rise * rise), from_source + from_listener);
    const double spread = (part.max - part.min) / (from_source * from_listener);
    const double together = spread * std::max(of_sign[0], of_sign[1]);
    of_sign[largest_sign] -= largest;
    const double whole = largest_factor * 2.0 * (math::kPi - largest_angle + kMinAngle) / length;
    const double apart =
        std::min(whole, spread * largest) + spread * std::max({of_sign[0], of_sign[1], 0.0});
    constexpr double kQuadratureError = 1e-4;
    return std::min(together, apart) / (4.0 * math::kPi) + kQuadratureError / length;
}

bool EdgeLevelFilter::may_be_wanted(const geometry::Wedge& wedge,
                                    const geometry::Interval& part,
                                    const frustum::EdgeEnd& source,
                                    const frustum::EdgeEnd& listener,
                                    std::size_t listener_index) const {
    const double min_pressure = min_pressure_[listener_index];
    if (min_pressure <= 0.0) {
        return true;
    }
    const bool counts_faces =
        static_cast<int>(source.reflections + listener.reflections) < max_order_;
    const auto of_face = [&](std::size_t i) {
        return counts_faces ? max_reflection_[wedge.faces[i].facet] : 0.0;
    };
    constexpr double kRoundedUp = 1.0 + 0x1p-10;
    const double factor =
        kRoundedUp * loudest_source_ * source.max_pressure_factor * listener.max_pressure_factor;
    return factor *
               max_pressure_between(wedge, part, source, listener, {1.0, of_face(0), of_face(1)}) >=
           min_pressure;
}

}  // namespace earshot::propagation
