// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/wedge.h"

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

namespace earshot::propagation {

// Sound that a rigid edge diffracts once, by the line integral of Svensson, Fred and Vanderkooy
// (1999): exact at every frequency and for edges of any length. Time runs as e^{+j w t}; a source
// gives e^{-jkr} / r in the free field, r in metres and k the wave number in radians per metre.

/// Whether a specular path reaches the listener close to the boundary of its zone.
enum class ZoneSide {
    by_angle,  ///< as the angles of source and listener say
    lit,       ///< the path exists
    shadow,    ///< the path does not exist
};

/// What an edge diffracts between a source and a listener, which may be images. Four terms are
/// integrated; each smooths the specular paths of one kind: `direct` two, the reflections in the
/// first and in the second face one each. The arrays have these three in this order.
struct EdgeDiffraction {
    double open_angle = 0.0;  ///< of the wedge, radians, in (0, 2 pi]
    /// Angles in [0, open_angle]. Precondition: radii above 0.
    geometry::WedgePoint source{}, listener{};
    /// The part of the edge that source and listener both see, metres along the edge, ascending.
    double z_begin = 0.0, z_end = 0.0;
    /// Factors of the terms: the reflection factors of the faces. 1 for rigid faces.
    std::array<double, 3> pressure_factors{1.0, 1.0, 1.0};
    /// Decides the sign of a term whose zone boundary is closer than kMaxBoundaryAngle.
    std::array<ZoneSide, 3> sides{ZoneSide::by_angle, ZoneSide::by_angle, ZoneSide::by_angle};
};

/// Radians. Positions and directions in double precision may be off by this much after mirroring.
inline constexpr double kMaxBoundaryAngle = 1e-9;

/// Sound pressure at the listener, spreading included, its phase counted from the emission. Per
/// kind of term, in the order of EdgeDiffraction. The upright and the inverted sums, over any
/// kinds, are each a minimum-phase response after its first arrival, which the sum of both need not
/// be.
struct DiffractedPressure {
    /// Of terms that begin with the sign of the source.
    std::array<std::complex<double>, 3> upright{};
    /// Of terms that begin with the other sign.
    std::array<std::complex<double>, 3> inverted{};

    std::complex<double> total() const noexcept {
        return upright[0] + upright[1] + upright[2] + inverted[0] + inverted[1] + inverted[2];
    }
};

/// The length in metres of the shortest way from source to listener over the visible part of the
/// edge.
double shortest_length(const EdgeDiffraction& edge) noexcept;

/// Within 6e-5 / shortest way over the edge's line, and 0.002 dB. Precondition: wave_number > 0.
DiffractedPressure diffracted_pressure(const EdgeDiffraction& edge, double wave_number);

/// The pressure of one edge at several frequencies, which share most of the work. The bits are
/// those of diffracted_pressure().
class EdgeSpectrum {
public:
    explicit EdgeSpectrum(const EdgeDiffraction& edge);
    EdgeSpectrum(EdgeSpectrum&&) noexcept;
    EdgeSpectrum& operator=(EdgeSpectrum&&) noexcept;
    ~EdgeSpectrum();

    /// Precondition: wave_number > 0.
    DiffractedPressure pressure(double wave_number);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A bound on the absolute value of each of diffracted_pressure()'s sums of terms, cheaper than the
/// pressure itself: typically 10 dB above it.
double max_diffracted_pressure(const EdgeDiffraction& edge, double wave_number) noexcept;

/// A bound on the absolute value of the total at every frequency, cheaper still: what would arrive
/// if the ways over all points of the edge were of one length.
double max_diffracted_pressure(const EdgeDiffraction& edge) noexcept;

/// An impulse response.
struct EdgeResponse {
    double first_length = 0.0;  ///< metres: sample i is at (first_length + i c / rate) / c seconds
    std::vector<double> upright;   ///< as in DiffractedPressure; 1 is the free field at 1 m
    std::vector<double> inverted;  ///< of the same size
};

/// The impulse response in samples, each the mean of the response over its interval of time: no
/// quadrature is needed. Ends with the edge, and after `max_samples` at the latest.
EdgeResponse diffraction_response(const EdgeDiffraction& edge,
                                  double sample_rate_hz,
                                  double speed_of_sound,
                                  std::size_t max_samples);

}  // namespace earshot::propagation
