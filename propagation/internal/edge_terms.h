// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/propagation/diffraction.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace earshot::propagation {

/// One of the four terms of the diffraction integrand, sin a / (cosh(nu eta) - cos a) times the
/// factor, where nu = pi / open angle and a the reduced angle, 0 on the zone boundary.
struct EdgeTerm {
    double sign = 0.0;       ///< of a, +1 in the lit zone
    double half_sine = 0.0;  ///< |sin(a / 2)|
    double half_cosine = 0.0;
    double sine = 0.0;   ///< |sin a|
    double angle = 0.0;  ///< |a|, radians
    double pressure_factor = 1.0;
    std::size_t kind = 0;  ///< 0 direct, 1 and 2 the faces
};

/// `angle` is nu phi; it is reduced before any sine is taken of it.
inline EdgeTerm edge_term(double angle,
                          std::size_t kind,
                          const std::array<double, 3>& factors,
                          const std::array<ZoneSide, 3>& sides) noexcept {
    const double reduced = angle - 2.0 * math::kPi * std::nearbyint(angle / (2.0 * math::kPi));
    EdgeTerm term;
    term.angle = std::abs(reduced);
    term.half_sine = math::sin(0.5 * term.angle);
    term.half_cosine = math::cos(0.5 * term.angle);
    term.sine = 2.0 * term.half_sine * term.half_cosine;
    term.sign = reduced > 0.0 ? 1.0 : -1.0;
    if (sides[kind] != ZoneSide::by_angle && term.angle <= kMaxBoundaryAngle) {
        term.sign = sides[kind] == ZoneSide::lit ? 1.0 : -1.0;
    }
    term.pressure_factor = factors[kind];
    term.kind = kind;
    return term;
}

/// In the order: direct, direct, first face, second face.
inline std::array<EdgeTerm, 4> edge_terms(double open_angle,
                                          double source_angle,
                                          double listener_angle,
                                          const std::array<double, 3>& factors,
                                          const std::array<ZoneSide, 3>& sides) noexcept {
    const double nu = math::kPi / open_angle;
    const double difference = source_angle - listener_angle;
    const double sum = source_angle + listener_angle;
    return {edge_term(nu * (math::kPi + difference), 0, factors, sides),
            edge_term(nu * (math::kPi - difference), 0, factors, sides),
            edge_term(nu * (math::kPi - sum), 1, factors, sides),
            edge_term(nu * (math::kPi + sum), 2, factors, sides)};
}

}  // namespace earshot::propagation
