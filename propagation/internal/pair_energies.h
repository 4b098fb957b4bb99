// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Energy times the reflections by one material, per arrival and per bin of the late energy.
struct Reflections {
    std::vector<double> arrivals, bins;
};

/// What arrives at a pair, and how often each material has reflected it.
class PairEnergies {
public:
    /// `pair` must outlive it.
    PairEnergies(const Scene& scene, const PairResult& pair);

    std::span<const audio::Arrival> arrivals() const { return arrivals_; }
    const audio::EnergyHistogram& late() const { return pair_.late; }
    const LateMaterials::Part& whole() const { return whole_; }
    const LateMaterials& materials() const { return pair_.late_materials; }
    std::size_t interval_of_bin(std::size_t bin) const { return interval_of_bin_[bin]; }
    double reflections_of_path(std::size_t path, std::size_t material) const {
        return reflections_of_path_[path * materials_ + material];
    }

    /// All rays but those of a part.
    LateMaterials::Part without(const LateMaterials::Part& part) const;

    /// The late energy as some of the rays have it.
    audio::EnergyHistogram late_of(const LateMaterials::Part& rays) const;

    /// Of one material and band; `late` is that of the rays.
    Reflections reflections(std::size_t material,
                            std::size_t band,
                            const LateMaterials::Part& rays,
                            const audio::EnergyHistogram& late) const;

    /// A sum over rays by interval, material and band, over the energy of these rays in the
    /// interval of a bin.
    double mean_of(std::span<const double> sums,
                   const LateMaterials::Part& rays,
                   std::size_t bin,
                   std::size_t material,
                   std::size_t band) const;

private:
    const PairResult& pair_;
    std::vector<audio::Arrival> arrivals_;
    std::size_t materials_;
    std::vector<double> reflections_of_path_;  // path, material
    LateMaterials::Part whole_;
    std::vector<std::size_t> interval_of_bin_;
};

/// Throws Error, about `purpose`, if the pair has late energy without materials
/// (Options::report_materials) or arrivals in place of paths.
void require_materials(const PairResult& pair, const char* purpose);

}  // namespace earshot::propagation
