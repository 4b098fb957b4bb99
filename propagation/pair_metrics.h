// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/room_metrics.h"
#include "earshot/audio/spatial_metrics.h"

#include <cstddef>
#include <optional>

namespace earshot::propagation {

/// Room-acoustic metrics of one source and listener at one time.
struct PairMetrics {
    std::size_t source = 0;         ///< index into Scene::sources
    std::size_t listener = 0;       ///< index into Scene::listeners
    double time = 0.0;              ///< seconds, of the scene's animation
    audio::RoomMetrics expected{};  ///< of the energies that arrive, see audio::energy_metrics
    audio::RoomMetrics response{};  ///< of the response, one realisation of them
    std::optional<double> schroeder_hz{};
    std::optional<audio::LateralMetrics> lateral{};    ///< of an ambisonic response
    std::optional<audio::BinauralMetrics> binaural{};  ///< of a binaural response
};

}  // namespace earshot::propagation
