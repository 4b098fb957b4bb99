// SPDX-License-Identifier: MIT
#include "support/arrival_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace earshot::support {

namespace {

using Complex = std::complex<double>;

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kFiner = 4;  // the phases' grid
constexpr double kFloor = 1e-10;   // of a band re the largest

/// exp(2 pi i k / size).
std::vector<Complex> roots_of_unity(std::size_t size) {
    std::vector<Complex> roots(size);
    for (std::size_t k = 0; k < size; ++k) {
        roots[k] = std::polar(1.0, 2.0 * kPi * static_cast<double>(k) / static_cast<double>(size));
    }
    return roots;
}

// Cooley and Tukey's transform in place, of a power of two; the exponent is positive.
void transform(std::vector<Complex>& values, const std::vector<Complex>& roots) {
    const std::size_t size = values.size();
    for (std::size_t k = 1, reversed = 0; k < size; ++k) {
        std::size_t bit = size / 2;
        for (; (reversed & bit) != 0; bit /= 2) {
            reversed ^= bit;
        }
        reversed ^= bit;
        if (k < reversed) {
            std::swap(values[k], values[reversed]);
        }
    }
    for (std::size_t half = 1; half < size; half *= 2) {
        for (std::size_t begin = 0; begin < size; begin += 2 * half) {
            for (std::size_t k = 0; k < half; ++k) {
                const Complex root = roots[k * (size / (2 * half))];
                const Complex even = values[begin + k];
                const Complex odd = values[begin + k + half];
                const Complex turned = {root.real() * odd.real() - root.imag() * odd.imag(),
                                        root.real() * odd.imag() + root.imag() * odd.real()};
                values[begin + k] = even + turned;
                values[begin + k + half] = even - turned;
            }
        }
    }
}

/// The height at a frequency of the function that is 1 at one centre, 0 at the others and linear
/// over log-frequency between them.
double hat(std::size_t band, double hz, std::span<const double> centres) {
    const double x = std::log(std::clamp(hz, centres.front(), centres.back()));
    const double centre = std::log(centres[band]);
    double height = 1.0;
    if (x < centre) {
        height = 1.0 - (centre - x) / (centre - std::log(centres[band - 1]));
    } else if (x > centre) {
        height = 1.0 - (x - centre) / (std::log(centres[band + 1]) - centre);
    }
    return std::max(0.0, height);
}

/// Linear pieces of the spectrum to the whole circle of bins.
std::vector<Complex> mirrored(const std::vector<Complex>& half) {
    std::vector<Complex> all(half);
    for (std::size_t k = half.size() - 2; k > 0; --k) {
        all.push_back(std::conj(half[k]));
    }
    return all;
}

std::vector<double> delayed_impulse(double fraction) {
    std::vector<double> taps(128, 0.0);
    if (fraction == 0.0) {
        taps[63] = 1.0;
        return taps;
    }
    const double beta = 0.1102 * (100.0 - 8.7);
    double sum = 0.0;
    for (std::size_t tap = 0; tap < taps.size(); ++tap) {
        const double t = static_cast<double>(tap) - 63.0 - fraction;
        const double window = std::cyl_bessel_i(0.0, beta * std::sqrt(1.0 - t * t / 4096.0));
        taps[tap] = std::sin(kPi * t) / (kPi * t) * window;
        sum += taps[tap];
    }
    for (double& tap : taps) {
        tap /= sum;
    }
    return taps;
}

}  // namespace

ArrivalReference::ArrivalReference(std::vector<double> centres_hz,
                                   double sample_rate,
                                   std::size_t filter_size)
    : centres_hz_(std::move(centres_hz)), sample_rate_(sample_rate), size_(filter_size) {
    // The minimum phase of a log-magnitude by its cepstrum, and that of a sum as the sum of phases.
    const std::size_t fine = kFiner * size_;
    const std::vector<Complex> roots = roots_of_unity(fine);
    for (std::size_t band = 0; band < centres_hz_.size(); ++band) {
        std::vector<Complex> half(fine / 2 + 1);
        for (std::size_t k = 0; k < half.size(); ++k) {
            const double hz = sample_rate_ * static_cast<double>(k) / static_cast<double>(fine);
            half[k] = hat(band, hz, centres_hz_);
        }
        std::vector<Complex> cepstrum = mirrored(half);
        transform(cepstrum, roots);
        for (std::size_t n = 0; n < fine; ++n) {
            const double fold = n == 0 || n == fine / 2 ? 1.0 : n < fine / 2 ? 2.0 : 0.0;
            cepstrum[n] = fold * cepstrum[n].real() / static_cast<double>(fine);
        }
        transform(cepstrum, roots);
        std::vector<double>& heights = hat_of_band_.emplace_back();
        std::vector<double>& phase = phase_of_band_.emplace_back();
        for (std::size_t k = 0; k <= size_ / 2; ++k) {
            heights.push_back(half[kFiner * k].real());
            phase.push_back(-cepstrum[kFiner * k].imag());  // of the negative exponent
        }
    }
    roots_ = roots_of_unity(size_);
}

std::vector<double> ArrivalReference::filter(const audio::Arrival& arrival) const {
    const auto used = std::span(arrival.pressure).first(centres_hz_.size());
    const double largest = *std::max_element(used.begin(), used.end());
    std::vector<double> log_pressures;
    for (const double pressure : used) {
        log_pressures.push_back(std::log(std::max(pressure / largest, kFloor)));
    }
    std::vector<Complex> half(size_ / 2 + 1);
    for (std::size_t k = 0; k < half.size(); ++k) {
        double log_magnitude = 0.0;
        double phase = 0.0;
        for (std::size_t band = 0; band < used.size(); ++band) {
            const double log_pressure = log_pressures[band];
            log_magnitude += log_pressure * hat_of_band_[band][k];
            phase += log_pressure * phase_of_band_[band][k];
        }
        half[k] = largest * std::exp(log_magnitude) * Complex(std::cos(phase), std::sin(phase));
    }
    half.back() = half.back().real();
    std::vector<Complex> all = mirrored(half);
    transform(all, roots_);
    std::vector<double> samples(size_);
    for (std::size_t n = 0; n < size_; ++n) {
        samples[n] = all[n].real() / static_cast<double>(size_);
    }
    return samples;
}

std::vector<double> ArrivalReference::piece(const audio::Arrival& arrival) const {
    const double position = arrival.delay * sample_rate_;
    const std::vector<double> taps = delayed_impulse(position - std::floor(position));
    const std::vector<double> samples = filter(arrival);
    std::vector<double> result(samples.size() + taps.size() - 1, 0.0);
    for (std::size_t tap = 0; tap < taps.size(); ++tap) {
        for (std::size_t n = 0; n < samples.size(); ++n) {
            result[tap + n] += taps[tap] * samples[n];
        }
    }
    return result;
}

std::vector<double> ArrivalReference::sum(std::span<const audio::Arrival> arrivals,
                                          std::span<const double> gains,
                                          std::size_t size) const {
    std::vector<double> result(size, 0.0);
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        const double gain = arrivals[i].is_inverted ? -gains[i] : gains[i];
        const auto whole =
            static_cast<std::ptrdiff_t>(std::floor(arrivals[i].delay * sample_rate_));
        const std::vector<double> samples = piece(arrivals[i]);
        for (std::size_t n = 0; n < samples.size(); ++n) {
            const std::ptrdiff_t at = whole - 63 + static_cast<std::ptrdiff_t>(n);
            if (at >= 0 && at < static_cast<std::ptrdiff_t>(size)) {
                result[static_cast<std::size_t>(at)] += gain * samples[n];
            }
        }
    }
    return result;
}

ResponseError response_error(std::span<const double> found, std::span<const double> expected) {
    double energy = 0.0, all = 0.0, peak = 0.0, largest = 0.0;
    for (std::size_t n = 0; n < expected.size(); ++n) {
        const double difference = found[n] - expected[n];
        energy += difference * difference;
        all += expected[n] * expected[n];
        peak = std::max(peak, std::abs(difference));
        largest = std::max(largest, std::abs(expected[n]));
    }
    return {10.0 * std::log10(energy / all), 20.0 * std::log10(peak / largest)};
}

}  // namespace earshot::support
