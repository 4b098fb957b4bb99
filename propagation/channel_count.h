// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/spatial.h"
#include "earshot/propagation/response.h"

#include <cstddef>

namespace earshot::propagation {

/// The channels of a response: 1, 2, or (ambisonic_order + 1)^2.
/// Precondition: 0 <= ambisonic_order <= audio::kMaxAmbisonicOrder.
inline std::size_t channel_count(Channels channels, int ambisonic_order) noexcept {
    switch (channels) {
        case Channels::mono:
            return 1;
        case Channels::binaural:
            return 2;
        case Channels::ambisonic:
            break;
    }
    return audio::ambisonic_channels(ambisonic_order);
}

}  // namespace earshot::propagation
