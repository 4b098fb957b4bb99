// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace earshot::propagation {

/// Radians: where a zone boundary is closer, the integrand is taken as if it were this far. A term
/// then differs by less than 1e-6 of itself from its limit, half the step of the sound it mends.
inline constexpr double kMinTermAngle = 1e-6;

/// The terms sin a / (cosh(nu eta) - cos a) of a wedge for two directions, in the order of
/// edge_terms().
class WedgeTerms {
public:
    /// `half_sines`, `half_cosines`: of a / 2; a need not be reduced.
    WedgeTerms(const std::array<double, 4>& half_sines,
               const std::array<double, 4>& half_cosines) noexcept {
        for (std::size_t i = 0; i < 4; ++i) {
            const double sign = half_sines[i] * half_cosines[i] >= 0.0 ? 1.0 : -1.0;
            const double half_sine = std::max(std::abs(half_sines[i]), 0.5 * kMinTermAngle);
            sine_[i] = sign * 2.0 * half_sine * std::abs(half_cosines[i]);
            offset_[i] = 2.0 * half_sine * half_sine;
            min_half_sine_ = std::min(min_half_sine_, half_sine);
        }
    }

    /// `root` is e^{nu eta / 2}.
    std::array<double, 4> values(double root) const noexcept {
        const double twice_sinh = root - 1.0 / root;
        const double rise = 0.5 * twice_sinh * twice_sinh;
        std::array<double, 4> values{};
        for (std::size_t i = 0; i < 4; ++i) {
            values[i] = sine_[i] / (rise + offset_[i]);
        }
        return values;
    }

    /// |sin(a / 2)| of the term that is closest to its zone boundary.
    double min_half_sine() const noexcept { return min_half_sine_; }

private:
    std::array<double, 4> sine_{}, offset_{};
    double min_half_sine_ = 1.0;
};

/// The terms of a wedge for one fixed direction and any other.
class DirectedTerms {
public:
    /// The fixed direction is that of the source, or that of the listener.
    DirectedTerms(double open_angle, double fixed_angle, bool is_source) noexcept
        : half_nu_(0.5 * math::kPi / open_angle), is_source_(is_source) {
        const double plus = half_nu_ * (math::kPi + fixed_angle);
        const double minus = half_nu_ * (math::kPi - fixed_angle);
        sin_plus_ = math::sin(plus);
        cos_plus_ = math::cos(plus);
        sin_minus_ = math::sin(minus);
        cos_minus_ = math::cos(minus);
    }

    WedgeTerms at(double angle) const noexcept {
        const double s = math::sin(half_nu_ * angle);
        const double c = math::cos(half_nu_ * angle);
        // nu (pi + fixed -+ angle) / 2 and nu (pi - fixed -+ angle) / 2.
        const double sin_plus_less = sin_plus_ * c - cos_plus_ * s;
        const double cos_plus_less = cos_plus_ * c + sin_plus_ * s;
        const double sin_minus_more = sin_minus_ * c + cos_minus_ * s;
        const double cos_minus_more = cos_minus_ * c - sin_minus_ * s;
        std::array<double, 4> sines{sin_plus_less,
                                    sin_minus_more,
                                    sin_minus_ * c - cos_minus_ * s,
                                    sin_plus_ * c + cos_plus_ * s};
        std::array<double, 4> cosines{cos_plus_less,
                                      cos_minus_more,
                                      cos_minus_ * c + sin_minus_ * s,
                                      cos_plus_ * c - sin_plus_ * s};
        if (!is_source_) {
            std::swap(sines[0], sines[1]);
            std::swap(cosines[0], cosines[1]);
        }
        return {sines, cosines};
    }

    /// pi / open angle.
    double nu() const noexcept { return 2.0 * half_nu_; }

private:
    double half_nu_;
    bool is_source_;
    double sin_plus_ = 0.0, cos_plus_ = 0.0, sin_minus_ = 0.0, cos_minus_ = 0.0;
};

}  // namespace earshot::propagation
