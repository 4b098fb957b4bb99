// SPDX-License-Identifier: MIT
#include "earshot/audio/internal/energy_course.h"

#include <algorithm>

namespace earshot::audio {
namespace {

constexpr double kGridRate = 10000.0;  // of the grid that energies are put on, hertz

// Energy per instant of the grid.
std::vector<double> energies_of(std::size_t band,
                                std::span<const Arrival> arrivals,
                                const EnergyHistogram& late) {
    double end = late.bin * static_cast<double>(late.energy.size());
    for (const Arrival& arrival : arrivals) {
        end = std::max(end, arrival.delay);
    }
    std::vector<double> energies(static_cast<std::size_t>(end * kGridRate) + 2, 0.0);
    for (const Arrival& arrival : arrivals) {
        energies[static_cast<std::size_t>(arrival.delay * kGridRate)] +=
            arrival.pressure[band] * arrival.pressure[band];
    }
    const double steps = late.bin * kGridRate;
    for (std::size_t n = 0; n < late.energy.size(); ++n) {
        const auto from = static_cast<std::size_t>(static_cast<double>(n) * steps);
        const auto to =
            std::max(from + 1, static_cast<std::size_t>(static_cast<double>(n + 1) * steps));
        for (std::size_t i = from; i < std::min(to, energies.size()); ++i) {
            energies[i] += late.energy[n][band] / static_cast<double>(to - from);
        }
    }
    return energies;
}

std::size_t onset_of(std::span<const double> energies) {
    constexpr double kBelow = 0.01;
    const double min_energy = kBelow * *std::max_element(energies.begin(), energies.end());
    std::size_t onset = 0;
    while (energies[onset] < min_energy) {
        ++onset;
    }
    return onset;
}

}  // namespace

EnergyCourse energy_course(const Bands& bands,
                           std::span<const Arrival> arrivals,
                           const EnergyHistogram& late) {
    EnergyCourse course = {.sample_rate = kGridRate};
    for (std::size_t band = 0; band < bands.count(); ++band) {
        course.energy.push_back(energies_of(band, arrivals, late));
        course.onset.push_back(onset_of(course.energy.back()));
    }
    return course;
}

}  // namespace earshot::audio
