// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/lattice_arrivals.h"

#include "earshot/geometry/vector.h"
#include "earshot/propagation/internal/air_kernel.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace earshot::propagation {
namespace {

/// Arrivals whose pressures are computed together.
constexpr std::size_t kBlock = 256;

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
    // Delays, directions and the walls of every path.
    const std::span<const double> lengths = paths.lengths();
    const bool name_facets = !are_alike(model.reflection);
    std::vector<audio::Arrival> arrivals(lengths.size());
    std::vector<std::uint8_t> orders(lengths.size()), sequences;
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        const frustum::PathArrival path = paths.at(i, name_facets);
        const geometry::Vec3 direction = geometry::direction_between(path.last_point, listener);
        arrivals[i].delay = lengths[i] / model.speed_of_sound;
        arrivals[i].direction = {direction.x, direction.y, direction.z};
        orders[i] = static_cast<std::uint8_t>(path.order);
        for (const geometry::FacetId facet : path.facets) {
            sequences.push_back(static_cast<std::uint8_t>(facet));
        }
    }
    // Pressures, by the operations of Simulator::State::describe() in its order, a block at a time.
    const std::size_t stride = model.air.stride();
    std::vector<double> walls(model.reflection.size() * stride);
    for (std::size_t i = 0; i < model.reflection.size(); ++i) {
        std::copy_n(model.reflection[i].begin(), model.bands, &walls[i * stride]);
    }
    std::vector<double> pressures(kBlock * stride);
    std::size_t kept = 0, reflections = 0;
    for (std::size_t first = 0; first < lengths.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, lengths.size() - first);
        const auto block_orders = std::span(orders).subspan(first, count);
        pressures_of_arrivals(
            {.stride = stride,
             .lengths = lengths.subspan(first, count),
             .rates = model.air_absorption ? model.air.rates() : std::span<const double>(),
             .walls = walls,
             .orders = block_orders,
             .sequences = std::span(sequences).subspan(name_facets ? reflections : 0)},
            pressures);
        reflections = std::accumulate(block_orders.begin(), block_orders.end(), reflections);
        // Keep what is loud enough in some band.
        for (std::size_t i = first; i < first + count; ++i) {
            const double* pressure = &pressures[(i - first) * stride];
            const bool is_wanted =
                lengths[i] > 0.0 && std::any_of(pressure, pressure + model.bands, [&](double p) {
                    return p >= model.min_pressure;
                });
            if (is_wanted) {
                if (kept != i) {
                    arrivals[kept] = arrivals[i];
                }
                std::copy_n(pressure, model.bands, arrivals[kept].pressure.begin());
                ++kept;
            }
        }
    }
    arrivals.resize(kept);
    return arrivals;
}

}  // namespace earshot::propagation
