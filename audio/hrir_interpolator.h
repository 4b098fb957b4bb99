// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace earshot::audio {

/// The responses of both ears, left first, to sound from one direction.
struct InterpolatedHrir {
    /// The first sample's place re the arrival at the head's centre; may be negative.
    std::ptrdiff_t begin = 0;
    std::array<std::vector<double>, 2> ears;
};

/// HRIRs of any direction from those of a set at its largest distance. Between directions delays
/// and responses are interpolated apart (Hartung, Braasch, Sterbing 1999): the responses of the
/// three directions around it, each moved to the weighted mean of their onsets, are added with the
/// same weights. A measured direction (within 1e-6 rad) has its measured responses, to the bit if
/// the set's centre_delay is 0. Where a set covers a part of the sphere or one plane, other
/// directions are taken for the closest on its border. Const members may be called from many
/// threads at once; copies share what was prepared.
class HrirInterpolator {
public:
    /// Throws Error if the set has no responses.
    explicit HrirInterpolator(const HrirSet& set);

    double sample_rate() const noexcept;

    /// `towards`: the unit vector to where the sound comes from; front, left, up.
    InterpolatedHrir at(const std::array<double, 3>& towards) const;

private:
    struct Prepared;
    std::shared_ptr<const Prepared> prepared_;
};

}  // namespace earshot::audio
