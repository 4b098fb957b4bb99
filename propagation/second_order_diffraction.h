// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/wedge.h"

#include <array>
#include <complex>
#include <cstddef>
#include <optional>

namespace earshot::propagation {

/// Sound that one edge diffracts to another, which diffracts it to the listener. Source and
/// listener may be images.
struct DoubleDiffraction {
    geometry::Wedge first{}, second{};
    geometry::Vec3 source{0.0}, listener{0.0};
    /// The parts of the edges that take part, metres along each, ascending.
    double first_begin = 0.0, first_end = 0.0;
    double second_begin = 0.0, second_end = 0.0;

    /// The faces that the way between the edges runs along, 0 or 1 of each wedge.
    struct CommonFace {
        int of_first = 0;
        int of_second = 0;
    };
    /// Set if the edges border on one flat face. A thin plate has two such ways, above and below,
    /// each of them a diffraction of its own.
    std::optional<CommonFace> common_face{};
};

/// Sound pressure at the listener, its phase counted from the emission, per kind of term at the
/// first edge and at the second, in the order of EdgeDiffraction.
struct DoublyDiffractedPressure {
    using Kinds = std::array<std::array<std::complex<double>, 3>, 3>;
    Kinds upright{};   ///< of products of terms that begin with the sign of the source
    Kinds inverted{};  ///< of those that begin with the other

    std::complex<double> total() const noexcept;
};

/// Radians of phase behind the shortest way, see doubly_diffracted_pressure().
inline constexpr double kMaxSecondOrderPhase = 500.0;

/// The double integral over both edges (Svensson, Fred and Vanderkooy 1999, section II.B), within
/// 0.001 dB or 1e-5 of the direct sound where no way is `max_phase` / 2 radians longer than the
/// shortest. Ways that are longer count ever less, from `max_phase` on not at all: the ends of
/// edges so far away are left out, which add little. The cost grows with the square of the
/// frequency up to there. Preconditions: wave_number > 0; max_phase >= 50; source, listener and
/// each of the parts lie outside the line of the other edge.
DoublyDiffractedPressure doubly_diffracted_pressure(
    const DoubleDiffraction& edges,
    double wave_number,
    double max_phase = kMaxSecondOrderPhase) noexcept;

/// A bound on the absolute value of the sum of any of doubly_diffracted_pressure()'s terms at any
/// frequency, with factors of at most 1: the integral of the integrand's absolute value, 1 % added
/// for the quadrature.
double max_doubly_diffracted_pressure(const DoubleDiffraction& edges) noexcept;

/// The sum of doubly_diffracted_pressure().
std::complex<double> second_order_pressure(const DoubleDiffraction& edges,
                                           double wave_number) noexcept;

/// The product of two coefficients of the uniform theory: the limit of second_order_pressure() at
/// high frequencies for edges without ends, at a cost that does not depend on the frequency. Within
/// 0.1 dB where the shortest way between the edges is 9 / k or longer.
std::complex<double> utd_second_order_pressure(const DoubleDiffraction& edges,
                                               double wave_number) noexcept;

/// The shortest way over both parts.
struct DoublePath {
    double first_z = 0.0;   ///< metres along the first edge
    double second_z = 0.0;  ///< and along the second
    double before = 0.0;    ///< metres from the source to the first edge
    double between = 0.0;   ///< to the second edge
    double after = 0.0;     ///< to the listener

    double length() const noexcept { return before + between + after; }
};
DoublePath shortest_path(const DoubleDiffraction& edges) noexcept;

}  // namespace earshot::propagation
