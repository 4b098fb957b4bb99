// SPDX-License-Identifier: MIT
#include "earshot/audio/harmonic_hrirs.h"

#include "earshot/audio/internal/fft.h"
#include "earshot/audio/internal/spiral_directions.h"
#include "earshot/audio/spatial.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

namespace earshot::audio {

namespace {

using Complex = std::complex<double>;

// Even weights over so many directions of a spiral integrate products of harmonics of order 5
// within 1e-3.
constexpr std::size_t kDirections = 600;
constexpr double kPhaseLimit = 2000.0;  // hertz
// Room for what the change of phase at the limit spreads.
constexpr std::size_t kMargin = 64;  // samples

/// Responses of all directions, with a common first sample.
struct Responses {
    std::ptrdiff_t begin = 0;
    std::size_t length = 0;
    std::vector<InterpolatedHrir> directions;
};

Responses responses_of(const HrirInterpolator& hrirs,
                       std::span<const std::array<double, 3>> directions) {
    Responses responses;
    std::ptrdiff_t end = 0;
    for (const auto& towards : directions) {
        const InterpolatedHrir& hrir = responses.directions.emplace_back(hrirs.at(towards));
        responses.begin = std::min(responses.begin, hrir.begin);
        end = std::max(end, hrir.begin + static_cast<std::ptrdiff_t>(hrir.ears[0].size()));
    }
    responses.length = static_cast<std::size_t>(end - responses.begin);
    return responses;
}

/// The harmonics of every direction.
std::vector<std::vector<double>> harmonics_of(std::span<const std::array<double, 3>> directions,
                                              int order) {
    std::vector<std::vector<double>> rows;
    for (const auto& towards : directions) {
        std::vector<double>& row = rows.emplace_back(ambisonic_channels(order));
        spherical_harmonics(order, towards, row);
    }
    return rows;
}

/// Of one bin and all channels: the projection of values per direction, which is the solution of
/// least squares where the harmonics are orthogonal over the directions.
void project(const std::vector<std::vector<double>>& harmonics,
             std::span<const Complex> values,
             int order,
             std::span<Complex> coefficients) {
    std::fill(coefficients.begin(), coefficients.end(), Complex());
    for (std::size_t d = 0; d < values.size(); ++d) {
        for (std::size_t channel = 0; channel < coefficients.size(); ++channel) {
            coefficients[channel] += harmonics[d][channel] * values[d];
        }
    }
    // SN3D: the mean square of a harmonic of degree l is 1 / (2 l + 1).
    std::size_t channel = 0;
    for (int degree = 0; degree <= order; ++degree) {
        const double factor = (2.0 * degree + 1.0) / static_cast<double>(values.size());
        for (int m = 0; m < 2 * degree + 1; ++m) {
            coefficients[channel] *= factor;
            ++channel;
        }
    }
}

Complex sum_of(const std::vector<double>& harmonics, std::span<const Complex> coefficients) {
    Complex sum;
    for (std::size_t channel = 0; channel < coefficients.size(); ++channel) {
        sum += harmonics[channel] * coefficients[channel];
    }
    return sum;
}

/// One ear: filters per channel.
std::vector<std::vector<double>> filters_of(const Responses& responses,
                                            std::size_t ear,
                                            const std::vector<std::vector<double>>& harmonics,
                                            int order,
                                            double sample_rate) {
    const std::size_t channels = ambisonic_channels(order);
    const RealFft fft(power_of_two_from(responses.length + 2 * kMargin));
    std::vector<std::vector<Complex>> spectra;  // per direction
    std::vector<double> signal(fft.size());
    for (const InterpolatedHrir& hrir : responses.directions) {
        std::fill(signal.begin(), signal.end(), 0.0);
        std::copy(
            hrir.ears[ear].begin(),
            hrir.ears[ear].end(),
            signal.begin() + (hrir.begin - responses.begin) + static_cast<std::ptrdiff_t>(kMargin));
        fft.forward(signal, spectra.emplace_back(fft.bins()));
    }
    std::vector<std::vector<Complex>> filters(channels, std::vector<Complex>(fft.bins()));
    std::vector<Complex> values(spectra.size()), coefficients(channels);
    Complex slope;  // the turn of the sound at the head's centre from bin to bin: its delay
    for (std::size_t bin = 0; bin < fft.bins(); ++bin) {
        const double frequency =
            static_cast<double>(bin) * sample_rate / static_cast<double>(fft.size());
        for (std::size_t d = 0; d < spectra.size(); ++d) {
            values[d] = spectra[d][bin];
            if (frequency > kPhaseLimit) {
                // The phase goes on as the bin below has it.
                const Complex next = sum_of(harmonics[d], coefficients) * slope;
                const double length = std::sqrt(std::norm(next));
                const double magnitude = std::sqrt(std::norm(spectra[d][bin]));
                values[d] = length > 0.0 ? next * (magnitude / length) : Complex(magnitude);
            }
        }
        const Complex omnidirectional = coefficients[0];
        project(harmonics, values, order, coefficients);
        if (frequency <= kPhaseLimit && bin > 0) {
            slope += std::conj(omnidirectional) * coefficients[0];
        }
        for (std::size_t channel = 0; channel < channels; ++channel) {
            filters[channel][bin] = coefficients[channel];
        }
    }
    std::vector<std::vector<double>> taps;
    for (const std::vector<Complex>& filter : filters) {
        fft.inverse(filter, taps.emplace_back(fft.size()));
    }
    return taps;
}

}  // namespace

HarmonicHrirs harmonic_hrirs(const HrirInterpolator& hrirs, int order) {
    const std::vector<std::array<double, 3>> directions = spiral_directions(kDirections);
    const Responses responses = responses_of(hrirs, directions);
    const std::vector<std::vector<double>> harmonics = harmonics_of(directions, order);
    HarmonicHrirs result;
    result.latency = static_cast<std::size_t>(-responses.begin) + kMargin;
    for (std::size_t ear = 0; ear < 2; ++ear) {
        result.ears[ear] = filters_of(responses, ear, harmonics, order, hrirs.sample_rate());
    }
    return result;
}

}  // namespace earshot::audio
