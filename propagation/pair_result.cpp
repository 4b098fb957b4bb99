// SPDX-License-Identifier: MIT
#include "earshot/propagation/pair_result.h"

#include <cmath>

namespace earshot::propagation {

std::string_view name_of(PathKind kind) noexcept {
    switch (kind) {
        case PathKind::direct:
            return "direct";
        case PathKind::specular:
            return "specular";
        case PathKind::transmitted:
            break;
    }
    return "transmitted";
}

std::vector<audio::Arrival> arrivals_of(const PairResult& pair) {
    std::vector<audio::Arrival> arrivals;
    if (pair.paths.empty()) {
        return pair.arrivals;
    }
    arrivals.reserve(pair.paths.size());
    for (const Path& path : pair.paths) {
        audio::Arrival& arrival = arrivals.emplace_back(
            audio::Arrival{.delay = path.delay,
                           .pressure = path.pressure,
                           .direction = {path.arrival.x, path.arrival.y, path.arrival.z}});
        arrival.is_inverted = path.pressure[0] < 0.0;
        for (double& pressure : arrival.pressure) {
            pressure = std::abs(pressure);
        }
    }
    return arrivals;
}

}  // namespace earshot::propagation
