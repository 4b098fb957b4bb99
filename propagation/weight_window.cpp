// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/weight_window.h"

#include "earshot/base/math.h"

#include <algorithm>

namespace earshot::propagation {

using audio::Spectrum;

WeightWindow::WeightWindow(std::span<const Spectrum> decay,
                           const audio::Bands& bands,
                           double max_distance) {
    constexpr std::size_t kSteps = 256;
    // The classroom takes least time for a standard error of T30 where weights follow the decay
    // with this exponent: a few rays fewer tell of late sound than of early sound.
    constexpr double kExponent = 0.65;
    // T30 of 500 Hz and 1 kHz decides the number of rays. So weighted, the T30 of other bands has
    // about the same standard error.
    constexpr double kLowestMid_hz = 400.0, kHighestMid_hz = 1250.0, kOtherBands = 0.3;
    constexpr double kMinDecades = -4.5;  // 10 dB below the end of T30
    steps_per_metre_ = kSteps / max_distance;
    const auto parts = static_cast<double>(decay.size());
    for (std::size_t step = 0; step <= kSteps; ++step) {
        Spectrum& scale = scales_.emplace_back();
        const double position = parts * static_cast<double>(step) / kSteps;
        const auto next = std::min(static_cast<std::size_t>(position), decay.size() - 1);
        const double share = position - static_cast<double>(next);
        for (std::size_t band = 0; band < bands.count(); ++band) {
            const auto decades_at = [&](std::size_t part) {
                const double left = part == 0 ? 1.0 : decay[part - 1][band];
                return left > 0.0 ? std::max(math::log10(left), kMinDecades) : kMinDecades;
            };
            const double begin = decades_at(next);
            const double decades = begin + share * (decades_at(next + 1) - begin);
            const double hz = bands.nominal_hz()[band];
            scale[band] = math::pow10(-kExponent * decades) *
                          (hz >= kLowestMid_hz && hz <= kHighestMid_hz ? 1.0 : kOtherBands);
        }
    }
}

}  // namespace earshot::propagation
