// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/propagation/diffraction.h"

#include <complex>

namespace earshot::propagation {

// The uniform theory of diffraction (Kouyoumjian and Pathak 1974): the high-frequency limit of an
// edge without ends. Within 0.02 dB of diffracted_pressure() in the shadow zone where k rho >= 10,
// rho = rs rr / R0, as far as the ends of the edge can be left out; 3 dB off and more where not.

/// The diffraction coefficient of a rigid wedge, in the square root of metres. `distance` is the
/// distance parameter L of the theory in metres, `skew_sine` the sine of the angle between the
/// incident ray and the edge.
std::complex<double> utd_coefficient(double open_angle,
                                     double source_angle,
                                     double listener_angle,
                                     double skew_sine,
                                     double distance,
                                     double wave_number) noexcept;

/// The pressure that diffracted_pressure() approaches at high frequencies, for an edge without
/// ends: z_begin, z_end, factors and sides are not used.
std::complex<double> utd_pressure(const EdgeDiffraction& edge, double wave_number) noexcept;

}  // namespace earshot::propagation
