// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/radiated_sound.h"

#include <algorithm>
#include <cstddef>

namespace earshot::propagation {

void radiate(const RaySource& source, const audio::Bands& bands, Path& path) {
    if (source.directivity.is_omnidirectional()) {
        return;
    }
    const audio::Spectrum sent =
        source.directivity.pressure(bands, source.pose.seen_from(path.departure));
    for (std::size_t band = 0; band < bands.count(); ++band) {
        path.pressure[band] *= sent[band];
    }
}

bool is_silent(const audio::EnergyHistogram& histogram) {
    return std::all_of(
        histogram.energy.begin(), histogram.energy.end(), [](const audio::Spectrum& energies) {
            return std::all_of(
                energies.begin(), energies.end(), [](double energy) { return energy == 0.0; });
        });
}

}  // namespace earshot::propagation
