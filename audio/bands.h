// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

inline constexpr std::size_t kMaxBands = 31;

/// One value per band; entries past the band count are 0.
using Spectrum = std::array<double, kMaxBands>;

/// The frequency bands a simulation works in: octaves or third octaves at the nominal centres of
/// ISO 266. Exact mid-band frequencies (1000 * 10^(3n/10) or 10^(n/10), IEC 61260-1) are used in
/// calculations, nominal ones in files.
class Bands {
public:
    static const Bands& octaves();        ///< 31.5 Hz ... 16 kHz, 10 bands
    static const Bands& third_octaves();  ///< 20 Hz ... 20 kHz, 31 bands

    std::size_t count() const noexcept { return nominal_hz_.size(); }
    std::span<const double> nominal_hz() const noexcept { return nominal_hz_; }
    std::span<const double> exact_hz() const noexcept { return exact_hz_; }
    double lower_edge_hz(std::size_t band) const noexcept;  ///< exact centre over sqrt of the width
    double upper_edge_hz(std::size_t band) const noexcept;

private:
    Bands(std::vector<double> nominal_hz, double first_exponent, double step, double width);
    std::vector<double> nominal_hz_, exact_hz_;
    double half_width_ratio_ = 0.0;
};

}  // namespace earshot::audio
