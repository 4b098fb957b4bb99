// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"
#include "earshot/audio/internal/noise_floor.h"

#include <cstddef>
#include <vector>

namespace earshot::audio {

/// Energy over time in one band of a response.
struct BandCourse {
    std::vector<double> squared{};  ///< per sample, what the filter rings before and after included
    std::size_t onset = 0;          ///< sample of `squared`
    NoiseFloor noise{};             ///< of a measured response
};

/// `squared`: of the band; sample n of the response is sample n + lead. `onset`: a sample of the
/// response. A measured response is cut off where its decay meets its noise; where that is low
/// enough, its energy is subtracted from what is before (Chu 1978) and the decay behind is in
/// `noise`: the most accurate of the compensations that Guski and Vorlaender 2014 compare.
BandCourse band_course(std::vector<double> squared,
                       std::size_t lead,
                       double bandwidth_hz,
                       const ImpulseResponse& response,
                       std::size_t onset,
                       bool ends_in_noise);

}  // namespace earshot::audio
