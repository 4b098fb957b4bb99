// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/hum.h"

#include "earshot/audio/internal/band_energy.h"
#include "earshot/audio/internal/fft.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace earshot::audio {

namespace {

constexpr std::array<double, 2> kMainsHz = {50.0, 60.0};
constexpr int kHarmonics = 12;
constexpr double kMinTime = 0.2;           // seconds, to tell 50 from 60 Hz
constexpr double kMinRatio = 10.0;         // of a line's mean power density to that beside it
constexpr double kMaxChange = 2.0;         // of a steady line's power from one part to the other
constexpr double kHalfWidth = 2.0;         // of the Hann window's main lobe, in 1 / time
constexpr double kMainsTolerance = 0.004;  // 50 Hz +- 0.2 Hz, held by the grid's regulation

/// Power density of a part of the recording at the bins of a transform, Hann window.
class PowerSpectrum {
public:
    PowerSpectrum(std::span<const double> samples, double sample_rate)
        : sample_rate_(sample_rate),
          time_(static_cast<double>(samples.size()) / sample_rate),
          fft_size_(power_of_two_from(std::max<std::size_t>(4, samples.size()))) {
        const RealFft fft(fft_size_);
        std::vector<double> windowed(fft_size_, 0.0);
        for (std::size_t n = 0; n < samples.size(); ++n) {
            const double phase =
                2.0 * math::kPi * static_cast<double>(n) / static_cast<double>(samples.size());
            windowed[n] = samples[n] * 0.5 * (1.0 - math::cos(phase));
        }
        std::vector<std::complex<double>> spectrum(fft.bins());
        fft.forward(windowed, spectrum);
        for (const auto& bin : spectrum) {
            power_.push_back(std::norm(bin));
        }
    }

    double time() const { return time_; }
    double frequency_of(std::size_t bin) const {
        return sample_rate_ * static_cast<double>(bin) / static_cast<double>(fft_size_);
    }
    std::size_t bins() const { return power_.size(); }
    double power(std::size_t bin) const { return power_[bin]; }

    /// Sum and number of the bins from one frequency to another.
    struct Sum {
        double power = 0.0, bins = 0.0;
    };
    Sum between(double from_hz, double to_hz) const {
        const double per_bin = frequency_of(1);
        const auto end =
            std::min(bins(), static_cast<std::size_t>(std::floor(to_hz / per_bin)) + 1);
        Sum sum;
        for (auto k = static_cast<std::size_t>(std::ceil(std::max(0.0, from_hz) / per_bin));
             k < end;
             ++k) {
            sum.power += power_[k];
            sum.bins += 1.0;
        }
        return sum;
    }

private:
    double sample_rate_;
    double time_;
    std::size_t fft_size_;
    std::vector<double> power_;
};

/// The power of the line at a frequency above what is beside it; 0 if there is no line.
double line_power(const PowerSpectrum& spectrum, double frequency_hz, double mains_hz) {
    const double half = kHalfWidth / spectrum.time() + kMainsTolerance * frequency_hz;
    const auto line = spectrum.between(frequency_hz - half, frequency_hz + half);
    const auto below = spectrum.between(frequency_hz - 0.45 * mains_hz, frequency_hz - half);
    const auto above = spectrum.between(frequency_hz + half, frequency_hz + 0.45 * mains_hz);
    const double beside_bins = below.bins + above.bins;
    if (line.bins == 0.0 || beside_bins == 0.0) {
        return 0.0;
    }
    const double beside = (below.power + above.power) / beside_bins;
    return line.power / line.bins > kMinRatio * beside ? line.power - beside * line.bins : 0.0;
}

/// Power through a band's filter.
double band_power(const Bands& bands, std::size_t band, const PowerSpectrum& spectrum) {
    double sum = 0.0;
    for (std::size_t k = 0; k < spectrum.bins(); ++k) {
        sum += spectrum.power(k) * band_power_gain(bands, band, spectrum.frequency_of(k));
    }
    return sum;
}

}  // namespace

Hum find_hum(const Bands& bands, std::span<const double> samples, double sample_rate) {
    Hum hum{.mains_hz = 0.0, .noise_share = std::vector<double>(bands.count(), 0.0)};
    const std::size_t quarter = samples.size() / 4;
    if (static_cast<double>(quarter) < kMinTime * sample_rate) {
        return hum;
    }
    const PowerSpectrum earlier(samples.subspan(samples.size() - 2 * quarter, quarter),
                                sample_rate);
    const PowerSpectrum later(samples.last(quarter), sample_rate);
    double loudest = 0.0;
    for (const double mains_hz : kMainsHz) {
        std::vector<double> in_band(bands.count(), 0.0);
        double sum = 0.0;
        for (int harmonic = 1; harmonic <= kHarmonics; ++harmonic) {
            const double frequency_hz = harmonic * mains_hz;
            const double before = line_power(earlier, frequency_hz, mains_hz);
            const double after = line_power(later, frequency_hz, mains_hz);
            if (before > 0.0 && after > 0.0 && before < kMaxChange * after &&
                after < kMaxChange * before) {
                sum += after;
                for (std::size_t band = 0; band < bands.count(); ++band) {
                    in_band[band] += after * band_power_gain(bands, band, frequency_hz);
                }
            }
        }
        if (sum > loudest) {
            loudest = sum;
            hum = {mains_hz, in_band};
        }
    }
    for (std::size_t band = 0; hum.mains_hz > 0.0 && band < bands.count(); ++band) {
        const double all = band_power(bands, band, later);
        hum.noise_share[band] = all > 0.0 ? std::min(1.0, hum.noise_share[band] / all) : 0.0;
    }
    return hum;
}

}  // namespace earshot::audio
