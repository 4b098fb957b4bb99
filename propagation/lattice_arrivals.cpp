// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/lattice_arrivals.h"

#include "earshot/geometry/vector.h"

#include <algorithm>
#include <cmath>

namespace earshot::propagation {
namespace {

/// Whether all walls reflect alike, so that only the number of reflections counts.
bool are_alike(std::span<const audio::Spectrum> reflection) {
    return std::all_of(reflection.begin(), reflection.end(), [&](const audio::Spectrum& wall) {
        return wall == reflection.front();
    });
}

}  // namespace

std::vector<audio::Arrival> describe_arrivals(frustum::PathArrivals& paths,
                                              const geometry::Vec3& listener,
                                              const ArrivalModel& model) {
    const std::span<const double> lengths = paths.lengths();
    const std::vector<double> air =
        model.air != nullptr ? model.air->pressures(lengths) : std::vector<double>();
    const bool name_facets = !are_alike(model.reflection);
    std::vector<audio::Arrival> arrivals;
    arrivals.reserve(lengths.size());
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        const frustum::PathArrival path = paths.at(i, name_facets);
        audio::Arrival& arrival = arrivals.emplace_back();
        arrival.delay = lengths[i] / model.speed_of_sound;
        // In the order of Simulator::State::describe(): spreading, air, walls.
        double* pressure = arrival.pressure.data();
        std::fill_n(pressure, model.bands, 1.0 / lengths[i]);
        for (std::size_t band = 0; band < model.bands && model.air != nullptr; ++band) {
            pressure[band] *= air[i * model.air->stride() + band];
        }
        for (std::size_t k = 0; k < path.order; ++k) {
            const audio::Spectrum& wall = model.reflection[name_facets ? path.facets[k] : 0];
            for (std::size_t band = 0; band < model.bands; ++band) {
                pressure[band] *= wall[band];
            }
        }
        const geometry::Vec3 direction = geometry::direction_between(path.last_point, listener);
        arrival.direction = {direction.x, direction.y, direction.z};
        const bool is_wanted =
            lengths[i] > 0.0 && std::any_of(pressure, pressure + model.bands, [&](double p) {
                return p >= model.min_pressure;
            });
        if (!is_wanted) {
            arrivals.pop_back();
        }
    }
    return arrivals;
}

}  // namespace earshot::propagation
