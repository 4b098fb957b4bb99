// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/hrir_onset.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace earshot::audio {

namespace {

constexpr std::size_t kOversampling = 4;

// -20 dB: above the noise of measured sets, and below the first wave at the ear on the far side,
// which a later one often exceeds.
constexpr double kThreshold = 0.1;

}  // namespace

// As much room again lets the interpolation of the last samples ring without reaching the first.
OnsetFinder::OnsetFinder(std::size_t max_samples)
    : fft_(power_of_two_from(std::max<std::size_t>(2 * max_samples, 4))),
      fine_fft_(kOversampling * fft_.size()) {}

std::optional<double> OnsetFinder::operator()(std::span<const double> response) const {
    EARSHOT_ASSERT(2 * response.size() <= fft_.size());
    std::vector<double> signal(fft_.size(), 0.0);
    std::copy(response.begin(), response.end(), signal.begin());
    std::vector<std::complex<double>> spectrum(fft_.bins());
    fft_.forward(signal, spectrum);
    spectrum.resize(fine_fft_.bins(), 0.0);
    std::vector<double> fine(fine_fft_.size());
    fine_fft_.inverse(spectrum, fine);
    fine.resize(kOversampling * response.size());

    double maximum = 0.0;
    for (const double value : fine) {
        maximum = std::max(maximum, std::abs(value));
    }
    if (maximum == 0.0) {
        return std::nullopt;
    }
    const double threshold = kThreshold * maximum;
    std::size_t n = 0;
    while (std::abs(fine[n]) < threshold) {
        ++n;
    }
    // Between the two values that enclose the threshold the magnitude is taken to be linear.
    double position = static_cast<double>(n);
    if (n > 0) {
        const double below = std::abs(fine[n - 1]);
        position -= (std::abs(fine[n]) - threshold) / (std::abs(fine[n]) - below);
    }
    return position / static_cast<double>(kOversampling);
}

}  // namespace earshot::audio
