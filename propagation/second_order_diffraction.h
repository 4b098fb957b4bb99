// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

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

/// The pressure of two edges at several frequencies, which share the work: the double integral over
/// both edges (Svensson, Fred and Vanderkooy 1999, section II.B). The integrand is integrated along
/// curves of equal length of the way, which gives the impulse response, and its transform is exact
/// at any frequency: the cost depends neither on frequency nor on the length of the edges. Within
/// 0.001 dB, or 1e-5 of the free field at the distance of the shortest way.
class EdgePairSpectrum {
public:
    /// `max_wave_number`: the largest that will be asked for, above 0. Precondition: source,
    /// listener and each of the parts lie outside the line of the other edge; parts may share an
    /// end.
    EdgePairSpectrum(const DoubleDiffraction& edges, double max_wave_number);
    EdgePairSpectrum(EdgePairSpectrum&&) noexcept;
    EdgePairSpectrum& operator=(EdgePairSpectrum&&) noexcept;
    ~EdgePairSpectrum();

    /// Precondition: wave_number > 0.
    DoublyDiffractedPressure pressure(double wave_number) const noexcept;

    /// The integral of the absolute values of all products of terms: no sum of terms, with factors
    /// of at most 1, is larger at any frequency, but for the error of the quadrature.
    double sum_of_amplitudes() const noexcept;

private:
    struct Panel;
    double min_length_ = 0.0;  // metres
    double factor_ = 0.0;
    std::array<bool, 16> is_upright_{};  // by product of terms
    std::vector<Panel> panels_;
};

/// EdgePairSpectrum::pressure() of one frequency.
DoublyDiffractedPressure doubly_diffracted_pressure(const DoubleDiffraction& edges,
                                                    double wave_number);

/// A bound on the absolute value of doubly_diffracted_pressure()'s sum at any frequency, from the
/// ends of the parts alone, far cheaper than the integral. Also with a factor from 0 to 1 for each
/// kind at either edge, but not of a choice of pairs of kinds, which may be more. It holds for all
/// parts within these, also where these leave the air of the wedges.
double max_doubly_diffracted_pressure(const DoubleDiffraction& edges) noexcept;

/// Per edge, and by kind of term there: an interval of the factors that the terms take, within
/// [0, 1].
using TermFactors = std::array<std::array<geometry::Interval, 3>, 2>;
inline constexpr TermFactors kAnyTermFactors{
    {{{{0.0, 1.0}, {0.0, 1.0}, {0.0, 1.0}}}, {{{0.0, 1.0}, {0.0, 1.0}, {0.0, 1.0}}}}};

/// A closer bound, of several ways together: parts are halved and the bounds of the pieces added up
/// until the sum is below `enough`, at most `max_halvings` times. A halving costs four bounds. What
/// is bounded are the products of terms with each choice of factors, added up; the closer factors
/// are known, the more of the terms of unlike sign cancel. Precondition: at least one way.
double max_doubly_diffracted_pressure(std::span<const DoubleDiffraction> ways,
                                      double enough,
                                      int max_halvings,
                                      std::span<const TermFactors> factors = {&kAnyTermFactors, 1});

/// The sum of doubly_diffracted_pressure().
std::complex<double> second_order_pressure(const DoubleDiffraction& edges, double wave_number);

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
