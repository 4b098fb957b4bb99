// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/internal/fft.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Power transmitted by the band's filter: a Butterworth band-pass of order 3 (six poles) whose
/// -3 dB points are the band edges. Within the class 1 limits of IEC 61260-1.
double band_power_gain(const Bands& bands, std::size_t band, double frequency_hz) noexcept;

/// Splits a signal into bands by filters of zero phase: an impulse rings as much before its time as
/// after it, so no band is late against another.
class BandEnergy {
public:
    /// Precondition: signal not empty, sample_rate > 0.
    BandEnergy(const Bands& bands, std::span<const double> signal, double sample_rate);

    /// False for a band that reaches past half the sample rate.
    bool covers(std::size_t band) const noexcept;

    /// The band's signal. Sample n of the signal is sample n + lead() here: the filters ring before
    /// its beginning and after its end. Precondition: covers(band).
    std::vector<double> filtered(std::size_t band) const;
    /// Its square per sample.
    std::vector<double> squared(std::size_t band) const;
    std::size_t lead() const noexcept { return lead_; }

    /// Sum of squared() for a signal that is one sample of 1. Precondition: covers(band).
    double of_unit_impulse(std::size_t band) const;

private:
    double frequency_of_bin(std::size_t bin) const noexcept;

    const Bands& bands_;
    double sample_rate_;
    std::size_t lead_;
    std::size_t squared_size_;
    RealFft fft_;
    std::vector<std::complex<double>> spectrum_;
};

}  // namespace earshot::audio
