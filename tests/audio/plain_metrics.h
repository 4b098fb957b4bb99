// SPDX-License-Identifier: MIT
//
// Late noise and metrics by the textbook: Fourier transforms by halving, filters made anew for
// every use, a logarithm, a root, a sine and a cosine per sample. An oracle that shares nothing
// with the library but its random numbers, and the measure of what lanes and caches save.
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

namespace earshot::audio::plain {

using Complex = std::complex<double>;
inline constexpr std::size_t kOctaves = 10;

/// Sums of x[n] exp(sign 2 pi i k n / size), the size being a power of two (Cooley & Tukey 1965).
inline std::vector<Complex> transform(const std::vector<Complex>& x, double sign) {
    const std::size_t half = x.size() / 2;
    if (half == 0) {
        return x;
    }
    std::vector<Complex> even(half), odd(half), result(x.size());
    for (std::size_t n = 0; n < half; ++n) {
        even[n] = x[2 * n];
        odd[n] = x[2 * n + 1];
    }
    even = transform(even, sign);
    odd = transform(odd, sign);
    for (std::size_t k = 0; k < half; ++k) {
        const double angle =
            sign * std::numbers::pi * static_cast<double>(k) / static_cast<double>(half);
        const Complex turned = std::polar(1.0, angle) * odd[k];
        result[k] = even[k] + turned;
        result[half + k] = even[k] - turned;
    }
    return result;
}

inline std::vector<Complex> spectrum_of(const std::vector<double>& signal,
                                        std::size_t begin,
                                        std::size_t size) {
    std::vector<Complex> padded(size);
    std::copy(signal.begin(), signal.end(), padded.begin() + static_cast<std::ptrdiff_t>(begin));
    return transform(padded, -1.0);
}

/// Power gain of a Butterworth band-pass of order 3 over an octave.
inline double octave_power(std::size_t octave, double hz) {
    const double centre = 1000.0 * std::pow(10.0, 0.3 * (static_cast<double>(octave) - 5.0));
    const double edge = std::pow(10.0, 0.15);
    const double x = (hz / centre - centre / hz) / (edge - 1.0 / edge);
    return hz > 0.0 ? 1.0 / (1.0 + std::pow(x, 6.0)) : 0.0;
}

/// The real signal of a spectrum times gain(hz).
template <typename Gain>
std::vector<double> filtered(std::vector<Complex> spectrum, double rate, const Gain& gain) {
    const std::size_t size = spectrum.size();
    for (std::size_t k = 0; k < size; ++k) {
        spectrum[k] *=
            gain(rate * static_cast<double>(std::min(k, size - k)) / static_cast<double>(size));
    }
    std::vector<double> signal;
    for (const Complex& sample : transform(spectrum, 1.0)) {
        signal.push_back(sample.real() / static_cast<double>(size));
    }
    return signal;
}

/// Samples that the filter of the lowest octave rings.
inline std::size_t lead(double rate) {
    const double width =
        1000.0 * std::pow(10.0, -1.5) * (std::pow(10.0, 0.15) - std::pow(10.0, -0.15));
    return static_cast<std::size_t>(std::ceil(6.0 / width * rate));
}

/// A response filtered by an octave; sample n of the response is sample n + lead().
inline std::vector<double> in_octave(const std::vector<double>& response,
                                     double rate,
                                     std::size_t octave) {
    const std::size_t length = response.size() + 2 * lead(rate);
    std::size_t size = 1;
    while (size < length) {
        size *= 2;
    }
    std::vector<double> signal =
        filtered(spectrum_of(response, lead(rate), size), rate, [&](double hz) {
            return std::sqrt(octave_power(octave, hz));
        });
    signal.resize(length);
    return signal;
}

/// The squares of in_octave().
inline std::vector<double> squared(const std::vector<double>& response,
                                   double rate,
                                   std::size_t octave) {
    std::vector<double> signal = in_octave(response, rate, octave);
    for (double& sample : signal) {
        sample *= sample;
    }
    return signal;
}

/// The largest normalised correlation of samples of the left ear from `begin` to `end` with those
/// of the right one up to 1 ms away (ISO 3382-1:2009, annex B).
inline double interaural_correlation(const std::vector<double>& left,
                                     const std::vector<double>& right,
                                     std::size_t begin,
                                     std::size_t end,
                                     double rate) {
    const auto max_delay = static_cast<std::ptrdiff_t>(std::lround(0.001 * rate));
    double left_energy = 0.0, right_energy = 0.0, largest = 0.0;
    for (std::ptrdiff_t delay = -max_delay; delay <= max_delay; ++delay) {
        double sum = 0.0;
        for (std::size_t n = begin; n < end; ++n) {
            const auto other = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(n) + delay);
            sum += other < right.size() ? left[n] * right[other] : 0.0;
            left_energy += delay == 0 ? left[n] * left[n] : 0.0;
            right_energy += delay == 0 ? right[n] * right[n] : 0.0;
        }
        largest = std::max(largest, std::abs(sum));
    }
    return largest / std::sqrt(left_energy * right_energy);
}

struct Metrics {
    double edt = 0.0, t20 = 0.0, t30 = 0.0;
    double c50_db = 0.0, c80_db = 0.0, d50 = 0.0, centre_time = 0.0, energy_db = 0.0;
};

/// ISO 3382-1:2009 of energies per sample, in full decay.
inline Metrics metrics_of(const std::vector<double>& energy, std::size_t onset, double rate) {
    std::vector<double> remaining(energy.size() + 1, 0.0);
    double moment = 0.0;
    for (std::size_t n = energy.size(); n-- > 0;) {
        remaining[n] = remaining[n + 1] + energy[n];
        moment += energy[n] * (static_cast<double>(n) - static_cast<double>(onset));
    }
    const double all = remaining.front();
    std::vector<double> level_db;
    for (std::size_t n = onset; n < energy.size(); ++n) {
        level_db.push_back(10.0 * std::log10(remaining[n] / all));
    }
    const auto first_below = [&](double limit_db) {
        return std::find_if(
                   level_db.begin(), level_db.end(), [&](double l) { return l < limit_db; }) -
               level_db.begin();
    };
    // The line by the normal equations.
    const auto time = [&](double from_db, double to_db) {
        const auto begin = from_db == 0.0 ? std::ptrdiff_t{0} : first_below(from_db);
        const auto end = first_below(to_db);
        double count = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
        for (auto n = begin; n < end; ++n) {
            const double at = static_cast<double>(n - begin) / rate;
            const double level = level_db[static_cast<std::size_t>(n)];
            count += 1.0;
            x += at;
            y += level;
            xx += at * at;
            xy += at * level;
        }
        return -60.0 * (count * xx - x * x) / (count * xy - x * y);
    };
    const auto late = [&](double limit) {
        return remaining[onset + static_cast<std::size_t>(std::lround(limit * rate))];
    };
    return {.edt = time(0.0, -10.0),
            .t20 = time(-5.0, -25.0),
            .t30 = time(-5.0, -35.0),
            .c50_db = 10.0 * std::log10((all - late(0.05)) / late(0.05)),
            .c80_db = 10.0 * std::log10((all - late(0.08)) / late(0.08)),
            .d50 = 1.0 - late(0.05) / all,
            .centre_time = moment / all / rate,
            .energy_db = 10.0 * std::log10(all)};
}

/// IEC 60268-16:2011 without noise, from the energies of the octaves 125 Hz ... 8 kHz per sample.
inline double speech_index(const std::array<std::vector<double>, 7>& octaves, double rate) {
    constexpr std::array<double, 14> kHz = {
        0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0, 10.0, 12.5};
    constexpr std::array<double, 7> kAlpha = {0.085, 0.127, 0.230, 0.233, 0.309, 0.224, 0.173};
    constexpr std::array<double, 6> kBeta = {0.085, 0.078, 0.065, 0.011, 0.047, 0.095};
    std::array<double, 7> transfer{};
    for (std::size_t octave = 0; octave < 7; ++octave) {
        for (const double hz : kHz) {
            Complex sum = 0.0;
            double all = 0.0;
            for (std::size_t n = 0; n < octaves[octave].size(); ++n) {
                const double angle = 2.0 * std::numbers::pi * hz * static_cast<double>(n) / rate;
                sum += octaves[octave][n] * Complex(std::cos(angle), std::sin(angle));
                all += octaves[octave][n];
            }
            const double m = std::abs(sum) / all;
            const double ratio_db = std::clamp(10.0 * std::log10(m / (1.0 - m)), -15.0, 15.0);
            transfer[octave] += (ratio_db + 15.0) / 30.0 / 14.0;
        }
    }
    double index = 0.0;
    for (std::size_t octave = 0; octave < 7; ++octave) {
        index += kAlpha[octave] * transfer[octave];
        index -= octave > 0 ? kBeta[octave - 1] * std::sqrt(transfer[octave - 1] * transfer[octave])
                            : 0.0;
    }
    return index;
}

/// Velvet noise, then white noise, shaped to the energies of the octaves.
inline std::vector<double> late_noise(const EnergyHistogram& histogram,
                                      double rate,
                                      std::uint64_t seed) {
    const double per_bin = histogram.bin * rate;
    const auto length =
        static_cast<std::size_t>(std::ceil(per_bin * static_cast<double>(histogram.energy.size())));
    std::size_t size = 4;
    while (size < length) {
        size *= 2;
    }
    std::vector<double> noise(length, 0.0);
    const double growth = histogram.reflection_growth;
    const double white_time = growth > 0.0 ? std::sqrt(0.5 * rate / growth) : 0.0;
    const double white_begin = std::floor(std::min(white_time * rate, static_cast<double>(length)));
    for (std::uint64_t k = 0; static_cast<double>(k) < growth / 3.0 * std::pow(white_time, 3.0);
         ++k) {
        const double time = std::cbrt(3.0 / growth * (static_cast<double>(k) + random(seed, 1, k)));
        if (std::floor(time * rate) < white_begin) {
            noise[static_cast<std::size_t>(time * rate)] +=
                (random(seed, 2, k) < 0.5 ? -1.0 : 1.0) * std::sqrt(rate / growth) / time;
        }
    }
    for (auto n = static_cast<std::size_t>(white_begin); n < length; ++n) {
        noise[n] = std::sqrt(12.0) * (random(seed, 0, n) - 0.5);
    }
    const std::vector<Complex> spectrum = spectrum_of(noise, 0, size);
    std::vector<double> sum(length, 0.0);
    for (std::size_t octave = 0; octave < kOctaves; ++octave) {
        const std::vector<double> signal = filtered(spectrum, rate, [&](double hz) {
            double all = 0.0;
            for (std::size_t other = 0; other < kOctaves; ++other) {
                all += octave_power(other, hz);
            }
            return hz > 0.0 ? octave_power(octave, hz) / all : 0.0;
        });
        for (std::size_t n = 0; n < length; ++n) {
            const auto bin = std::min(static_cast<std::size_t>(static_cast<double>(n) / per_bin),
                                      histogram.energy.size() - 1);
            sum[n] += signal[n] * std::sqrt(histogram.energy[bin][octave] / per_bin);
        }
    }
    return sum;
}

}  // namespace earshot::audio::plain
