// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/minimum_phase.h"

#include <algorithm>

namespace earshot::audio {

using Complex = std::complex<double>;

std::vector<double> minimum_phase(const RealFft& fft, std::span<const Complex> log_magnitude) {
    std::vector<double> cepstrum(fft.size());
    fft.inverse(log_magnitude, cepstrum);
    const std::size_t half = fft.size() / 2;
    for (std::size_t n = 1; n < half; ++n) {
        cepstrum[n] *= 2.0;
        cepstrum[fft.size() - n] = 0.0;
    }
    std::vector<Complex> folded(fft.bins());
    fft.forward(cepstrum, folded);
    std::vector<double> phase(fft.bins());
    std::transform(folded.begin(), folded.end(), phase.begin(), [](Complex c) { return c.imag(); });
    return phase;
}

}  // namespace earshot::audio
