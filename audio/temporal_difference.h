// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"

#include <cstddef>
#include <span>

namespace earshot::audio {

/// How estimates of a series of histograms differ from the exact ones, in parts of these.
struct TemporalDifference {
    /// From one update to the next: what is heard as flicker.
    double difference = 0.0;
    double error = 0.0;  ///< at each update
};

/// The temporal image difference of Barak et al. 2013 for echograms. With q the ratio of estimated
/// to exact energy of an update u, an interval k of `bins` bins and a band b, the root mean square
/// of q(u) - q(u - 1) over u, k and b, and that of q(u) - 1. What the exact energies change does
/// not count, as that of a moving camera does not there. Left out are intervals without exact
/// energy, in a difference at either update.
///
/// Preconditions: as many estimates as exact histograms, all of the same bins; bins > 0; a band is
/// below `bands`.
TemporalDifference temporal_difference(std::span<const EnergyHistogram> estimates,
                                       std::span<const EnergyHistogram> exact,
                                       std::size_t bands,
                                       std::size_t bins = kBinsPerSpan);

}  // namespace earshot::audio
