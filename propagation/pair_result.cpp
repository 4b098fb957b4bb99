// SPDX-License-Identifier: MIT
#include "earshot/propagation/pair_result.h"

#include <algorithm>
#include <cmath>

namespace earshot::propagation {

std::string_view name_of(PathKind kind) noexcept {
    switch (kind) {
        case PathKind::direct:
            return "direct";
        case PathKind::specular:
            return "specular";
        case PathKind::transmitted:
            return "transmitted";
        case PathKind::diffracted:
            break;
    }
    return "diffracted";
}

namespace {

/// `pressure` is of one sign in all bands.
audio::Arrival arrival_of(const Path& path, const audio::Spectrum& pressure) {
    audio::Arrival arrival{.delay = path.delay,
                           .pressure = pressure,
                           .direction = {path.arrival.x, path.arrival.y, path.arrival.z}};
    arrival.is_inverted = pressure[0] < 0.0;
    for (double& value : arrival.pressure) {
        value = std::abs(value);
    }
    return arrival;
}

bool is_silent(const audio::Spectrum& pressure) {
    return std::all_of(pressure.begin(), pressure.end(), [](double value) { return value == 0.0; });
}

}  // namespace

std::vector<audio::Arrival> arrivals_of(const PairResult& pair) {
    std::vector<audio::Arrival> arrivals;
    if (pair.paths.empty()) {
        return pair.arrivals;
    }
    arrivals.reserve(pair.paths.size());
    for (const Path& path : pair.paths) {
        if (path.parts.empty()) {
            arrivals.push_back(arrival_of(path, path.pressure));
        }
        for (const audio::Spectrum& part : path.parts) {
            if (!is_silent(part)) {
                arrivals.push_back(arrival_of(path, part));
            }
        }
    }
    return arrivals;
}

std::vector<audio::Arrival> energy_arrivals_of(const PairResult& pair) {
    return pair.energy_arrivals.empty() ? arrivals_of(pair) : pair.energy_arrivals;
}

}  // namespace earshot::propagation
