// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/internal/fft.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Power transmitted by the band's filter: a Butterworth band-pass of order 3 (six poles) whose
/// -3 dB points are the band edges. Within the class 1 limits of IEC 61260-1.
double band_power_gain(const Bands& bands, std::size_t band, double frequency_hz) noexcept;

/// What filters depend on.
struct FilterKey {
    const Bands* bands = nullptr;  ///< octaves() or third_octaves()
    double sample_rate = 0.0;      ///< hertz
    std::size_t size = 0;          ///< of the transform

    FilterKey(const Bands& of, double rate, std::size_t transform_size);
    friend bool operator==(const FilterKey&, const FilterKey&) = default;
};

/// A row of gains per band, one gain per bin of a transform.
class GainTable {
public:
    explicit GainTable(const FilterKey& key) : key_(key), fft_(key.size) {}

    const FilterKey& key() const noexcept { return key_; }
    const RealFft& fft() const noexcept { return fft_; }
    std::size_t rows() const noexcept { return rows_; }
    std::span<const double> gains(std::size_t band) const noexcept {
        return std::span(gains_).subspan(band * fft_.bins(), fft_.bins());
    }
    std::size_t bytes() const noexcept;

protected:
    /// Sets the rows of the first `count` bands to band_power_gain().
    void set_power_gains(std::size_t count);
    std::span<double> row(std::size_t band) noexcept {
        return std::span(gains_).subspan(band * fft_.bins(), fft_.bins());
    }

private:
    FilterKey key_;
    RealFft fft_;
    std::size_t rows_ = 0;
    LargeArray<double> gains_;
};

/// Filters of zero phase that split a signal into bands for measurement: band_power_gain(), of
/// bands that end below half the sample rate.
class BandFilters : public GainTable {
public:
    explicit BandFilters(const FilterKey& key);

    /// Of the filtered signal that is one sample of 1. Precondition: band < rows().
    double unit_impulse_energy(std::size_t band) const noexcept {
        return unit_impulse_energy_[band];
    }

private:
    std::vector<double> unit_impulse_energy_;
};

/// Filters of zero phase that sum to 1: band_power_gain() of a band over that of all bands whose
/// centre is below half the sample rate.
class ComplementaryFilters : public GainTable {
public:
    explicit ComplementaryFilters(const FilterKey& key);
};

}  // namespace earshot::audio
