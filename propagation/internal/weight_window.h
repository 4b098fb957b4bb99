// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// The weights that rays should have, by the distance that they have travelled: those below 1 end
/// by Russian roulette, those of 2 and more are split (Booth and Hendricks 1984; Vorba and Krivanek
/// 2016). Else the decay of a room hangs on few heavy rays, which happened to keep to walls that
/// absorb little.
class WeightWindow {
public:
    WeightWindow() = default;
    /// `decay`: share of the energy of each band that is left after equal steps of distance, the
    /// last of which ends at `max_distance` metres.
    WeightWindow(std::span<const audio::Spectrum> decay,
                 const audio::Bands& bands,
                 double max_distance);

    /// Whether there is none, so that all weights are allowed.
    bool empty() const noexcept { return scales_.empty(); }
    /// What to multiply the energy of each band with, re the first energy of a ray, so that the
    /// largest product is the ray's weight.
    const audio::Spectrum& scale_at(double travelled) const noexcept {
        const auto step = static_cast<std::size_t>(travelled * steps_per_metre_);
        return scales_[std::min(step, scales_.size() - 1)];
    }

private:
    std::vector<audio::Spectrum> scales_;
    double steps_per_metre_ = 0.0;
};

}  // namespace earshot::propagation
