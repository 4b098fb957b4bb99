// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Energy that arrives over time, per band.
struct EnergyCourse {
    double sample_rate = 0.0;                   ///< of the grid, hertz
    std::vector<std::vector<double>> energy{};  ///< per band and instant
    std::vector<std::size_t> onset{};           ///< per band, an instant
};

/// The energies of arrivals and of a histogram on a grid of a tenth of a millisecond. The onset is
/// the first energy less than 20 dB below the largest of an instant in its band. Precondition:
/// there is an arrival or a bin.
EnergyCourse energy_course(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late);

}  // namespace earshot::audio
