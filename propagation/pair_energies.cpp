// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/pair_energies.h"

#include "earshot/base/error.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::propagation {

using audio::EnergyHistogram;

namespace {

void add(double factor, const LateMaterials::Part& part, LateMaterials::Part& sum) {
    for (std::size_t i = 0; i < sum.energy.size(); ++i) {
        sum.energy[i] += factor * part.energy[i];
    }
    for (std::size_t i = 0; i < sum.reflections.size(); ++i) {
        sum.reflections[i] += factor * part.reflections[i];
    }
    for (std::size_t i = 0; i < sum.scatterings.size(); ++i) {
        sum.scatterings[i] += factor * part.scatterings[i];
    }
}

/// One arrival per path, whatever it is made of.
std::vector<audio::Arrival> arrivals_by_path(const PairResult& pair) {
    std::vector<audio::Arrival> arrivals;
    for (const Path& path : pair.paths) {
        audio::Arrival& arrival = arrivals.emplace_back(audio::Arrival{.delay = path.delay});
        std::transform(path.pressure.begin(),
                       path.pressure.end(),
                       arrival.pressure.begin(),
                       [](double pressure) { return std::abs(pressure); });
    }
    return arrivals;
}

/// Whether a path meets an edge at an interaction, rather than being reflected.
bool is_at_edge(const Path& path, std::size_t interaction) {
    return std::any_of(path.edges.begin(), path.edges.end(), [&](const auto& edge) {
        const geometry::Vec3& point = path.points[interaction + 1];
        const double detour = glm::distance(edge[0], point) + glm::distance(point, edge[1]) -
                              glm::distance(edge[0], edge[1]);
        constexpr double kRounding = 1e-12;
        return detour <= kRounding * (1.0 + glm::length(point));
    });
}

}  // namespace

PairEnergies::PairEnergies(const Scene& scene, const PairResult& pair)
    : pair_(pair), arrivals_(arrivals_by_path(pair)), materials_(scene.materials.size()) {
    reflections_of_path_.resize(pair.paths.size() * materials_);
    for (std::size_t i = 0; i < pair.paths.size(); ++i) {
        const Path& path = pair.paths[i];
        for (std::size_t k = 0; k < path.materials.size(); ++k) {
            if ((path.transmitted.empty() || path.transmitted[k] == 0) && !is_at_edge(path, k)) {
                reflections_of_path_[i * materials_ + path.materials[k]] += 1.0;
            }
        }
    }
    const LateMaterials& late = pair.late_materials;
    whole_ = {.share = 1.0,
              .energy = std::vector<double>(late.intervals() * late.bands),
              .reflections = std::vector<double>(late.touched.size())};
    if (!late.parts.empty()) {
        whole_.scatterings.resize(late.parts.front().scatterings.size());
    }
    for (const LateMaterials::Part& part : late.parts) {
        add(1.0, part, whole_);
    }
    for (std::size_t interval = 0; interval < late.intervals(); ++interval) {
        for (std::size_t bin = late.first_bin[interval]; bin < late.first_bin[interval + 1];
             ++bin) {
            interval_of_bin_.push_back(interval);
        }
    }
}

LateMaterials::Part PairEnergies::without(const LateMaterials::Part& part) const {
    LateMaterials::Part rest = whole_;
    add(-1.0, part, rest);
    rest.share = 1.0 - part.share;
    return rest;
}

EnergyHistogram PairEnergies::late_of(const LateMaterials::Part& rays) const {
    EnergyHistogram late = pair_.late;
    const std::size_t bands = materials().bands;
    for (std::size_t bin = 0; bin < late.energy.size(); ++bin) {
        for (std::size_t band = 0; band < bands; ++band) {
            const std::size_t cell = interval_of_bin_[bin] * bands + band;
            const double all = whole_.energy[cell];
            // Rounding may leave a negative rest of nothing.
            late.energy[bin][band] *=
                all > 0.0 ? std::max(rays.energy[cell], 0.0) / (rays.share * all) : 0.0;
        }
    }
    return late;
}

Reflections PairEnergies::reflections(std::size_t material,
                                      std::size_t band,
                                      const LateMaterials::Part& rays,
                                      const EnergyHistogram& late) const {
    Reflections result;
    for (std::size_t i = 0; i < arrivals_.size(); ++i) {
        const double pressure = arrivals_[i].pressure[band];
        result.arrivals.push_back(reflections_of_path(i, material) * (pressure * pressure));
    }
    for (std::size_t bin = 0; bin < late.energy.size(); ++bin) {
        result.bins.push_back(late.energy[bin][band] *
                              mean_of(rays.reflections, rays, bin, material, band));
    }
    return result;
}

double PairEnergies::mean_of(std::span<const double> sums,
                             const LateMaterials::Part& rays,
                             std::size_t bin,
                             std::size_t material,
                             std::size_t band) const {
    const std::size_t bands = materials().bands;
    const double energy = rays.energy[interval_of_bin_[bin] * bands + band];
    const double sum = sums[(interval_of_bin_[bin] * materials_ + material) * bands + band];
    return energy > 0.0 ? sum / energy : 0.0;
}

void require_materials(const PairResult& pair, const char* purpose) {
    if (!pair.arrivals.empty()) {
        throw Error(purpose, "needs the paths of each pair", "simulate with report_paths");
    }
    if (!pair.late.energy.empty() && pair.late_materials.parts.empty()) {
        throw Error(purpose,
                    "needs the materials that late sound has met",
                    "simulate with report_materials");
    }
}

}  // namespace earshot::propagation
