// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_model.h"

#include "earshot/audio/metric_derivatives.h"
#include "earshot/base/assert.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::propagation {

using audio::Arrival;
using audio::BandMetrics;
using audio::EnergyHistogram;
using audio::MetricDerivatives;
using audio::Spectrum;

namespace {

MetricVector vector_of(const BandMetrics& metrics) {
    MetricVector numbers{};
    for (std::size_t kind = 0; kind < kMetricCount; ++kind) {
        numbers[kind] = (metrics.*audio::kBandMetricKinds[kind].value).value_or(0.0);
    }
    return numbers;
}

}  // namespace

MaterialModel::MaterialModel(const Scene& scene, PairResult pair, const audio::Bands& bands)
    : bands_(bands),
      materials_(scene.materials.size()),
      pair_(std::make_unique<const PairResult>(std::move(pair))),
      energies_(scene, *pair_) {
    for (const Material& material : scene.materials) {
        simulated_.push_back(material.absorption.over(bands));
    }
    for (const Material& material : scene.materials) {
        simulated_.push_back(material.scattering.over(bands));
    }
}

// The energy has a factor of scattering for each reflection that scatters, and a factor of 1 -
// scattering for each other one; the probabilities of the rays' choices are divided out.
MaterialModel::Rays MaterialModel::rays_of(std::size_t band) const {
    const LateMaterials& late = energies_.materials();
    const LateMaterials::Part& part = energies_.whole();
    Rays rays;
    for (std::size_t interval = 0; interval < late.intervals(); ++interval) {
        const double energy = part.energy[interval * late.bands + band];
        for (std::size_t material = 0; material < materials_; ++material) {
            const std::size_t cell = (interval * materials_ + material) * late.bands + band;
            const double count = energy > 0.0 ? part.reflections[cell] / energy : 0.0;
            rays.reflections.push_back(count);
            if (part.scatterings.empty()) {
                continue;
            }
            const double scattered = energy > 0.0 ? part.scatterings[cell] / energy : 0.0;
            const double scattering = simulated_[materials_ + material][band];
            const bool is_inside = scattering > 0.0 && scattering < 1.0;
            rays.scattering_rates.push_back(is_inside ? scattered / scattering -
                                                            (count - scattered) / (1.0 - scattering)
                                                      : 0.0);
        }
    }
    return rays;
}

MaterialModel::Factors MaterialModel::factors(const Rays& rays,
                                              std::size_t band,
                                              std::span<const double> coefficients) const {
    // Logarithms of what a reflection changes by: of absorption, and of a specular reflection by
    // scattering; and the changes of scattering on the scale on which late energy follows it.
    std::vector<double> kept(materials_, 0.0), specular(materials_, 0.0), late(materials_, 0.0);
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
        const double before = simulated_[i][band];
        if (coefficients[i] == before) {
            continue;
        }
        EARSHOT_ASSERT(before < 1.0 && coefficients[i] < 1.0);
        const double change = math::log((1.0 - coefficients[i]) / (1.0 - before));
        if (i < materials_) {
            kept[i] = change;
        } else {
            EARSHOT_ASSERT(before > 0.0 && coefficients[i] > 0.0);
            specular[i - materials_] = change;
            late[i - materials_] = before * math::log(coefficients[i] / before);
        }
    }
    Factors result;
    for (std::size_t i = 0; i < energies_.arrivals().size(); ++i) {
        double sum = 0.0;
        for (std::size_t material = 0; material < materials_; ++material) {
            sum +=
                energies_.reflections_of_path(i, material) * (kept[material] + specular[material]);
        }
        result.arrivals.push_back(math::exp(sum));
    }
    for (std::size_t interval = 0; interval < energies_.materials().intervals(); ++interval) {
        double sum = 0.0;
        for (std::size_t material = 0; material < materials_; ++material) {
            const std::size_t cell = interval * materials_ + material;
            sum += rays.reflections[cell] * kept[material];
            if (late[material] != 0.0) {
                sum += rays.scattering_rates[cell] * late[material];
            }
        }
        result.intervals.push_back(math::exp(sum));
    }
    return result;
}

std::vector<Arrival> MaterialModel::arrivals_of_band(std::size_t band,
                                                     std::span<const double> factors) const {
    std::vector<Arrival> arrivals;
    arrivals.reserve(factors.size());
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const Arrival& from = energies_.arrivals()[i];
        Arrival& to = arrivals.emplace_back();
        to.delay = from.delay;
        to.pressure[band] = from.pressure[band] * std::sqrt(factors[i]);
    }
    return arrivals;
}

EnergyHistogram MaterialModel::late_of_band(std::size_t band,
                                            std::span<const double> factors) const {
    const EnergyHistogram& from = energies_.late();
    EnergyHistogram late = {.bin = from.bin,
                            .energy = std::vector<Spectrum>(from.energy.size()),
                            .reflection_growth = from.reflection_growth,
                            .full_decay = from.full_decay};
    for (std::size_t bin = 0; bin < late.energy.size(); ++bin) {
        late.energy[bin][band] = from.energy[bin][band] * factors[energies_.interval_of_bin(bin)];
    }
    return late;
}

bool MaterialModel::is_perfect(std::size_t coefficient,
                               std::span<const double> coefficients) const {
    const double value = coefficients[coefficient];
    return !(value < 1.0) || (coefficient >= materials_ && !(value > 0.0));
}

void MaterialModel::read_rates(const Rays& rays,
                               std::size_t band,
                               std::size_t coefficient,
                               std::span<const double> coefficients,
                               std::span<double> of_arrivals,
                               std::span<double> of_bins) const {
    const std::size_t material = coefficient % materials_;
    const double value = coefficients[coefficient];
    const double kept = 1.0 - value;
    for (std::size_t i = 0; i < of_arrivals.size(); ++i) {
        of_arrivals[i] *= -energies_.reflections_of_path(i, material) / kept;
    }
    for (std::size_t bin = 0; bin < of_bins.size(); ++bin) {
        const std::size_t cell = energies_.interval_of_bin(bin) * materials_ + material;
        of_bins[bin] *= coefficient < materials_
                            ? -rays.reflections[cell] / kept
                            : rays.scattering_rates[cell] * simulated_[coefficient][band] / value;
    }
}

ModelledMetrics MaterialModel::evaluate(std::size_t band,
                                        std::span<const double> coefficients) const {
    EARSHOT_ASSERT(coefficients.size() == materials_ || coefficients.size() == 2 * materials_);
    const Rays rays = rays_of(band);
    const Factors changes = factors(rays, band, coefficients);
    const std::vector<Arrival> arrivals = arrivals_of_band(band, changes.arrivals);
    const EnergyHistogram late = late_of_band(band, changes.intervals);
    const MetricDerivatives metrics(bands_, arrivals, late);
    ModelledMetrics result;
    for (std::size_t kind = 0; kind < kMetricCount; ++kind) {
        result.values[kind] = metrics.metrics().bands.at(band).*audio::kBandMetricKinds[kind].value;
    }
    std::vector<double> of_arrivals(arrivals.size()), of_bins(late.energy.size());
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
        if (is_perfect(i, coefficients)) {
            result.derivatives.emplace_back();
            continue;
        }
        for (std::size_t k = 0; k < arrivals.size(); ++k) {
            of_arrivals[k] = arrivals[k].pressure[band] * arrivals[k].pressure[band];
        }
        for (std::size_t bin = 0; bin < of_bins.size(); ++bin) {
            of_bins[bin] = late.energy[bin][band];
        }
        read_rates(rays, band, i, coefficients, of_arrivals, of_bins);
        result.derivatives.push_back(
            vector_of(metrics.of_band(band, {.arrivals = of_arrivals, .bins = of_bins})));
    }
    return result;
}

std::vector<MetricVector> MaterialModel::ray_deviations(std::size_t band) const {
    std::vector<MetricVector> deviations;
    const audio::HistogramReplicates& replicates = pair_->late_replicates;
    const auto count = static_cast<double>(replicates.energy.size());
    if (replicates.energy.size() < 2) {
        return deviations;
    }
    const std::size_t intervals = replicates.first_bin.size() - 1;
    std::vector<double> means(intervals, 0.0);
    for (const std::vector<Spectrum>& replicate : replicates.energy) {
        for (std::size_t interval = 0; interval < intervals; ++interval) {
            means[interval] += replicate[interval][band] / count;
        }
    }
    const Factors unchanged = {
        .arrivals = std::vector<double>(energies_.arrivals().size(), 1.0),
        .intervals = std::vector<double>(energies_.materials().intervals(), 1.0)};
    const EnergyHistogram late = late_of_band(band, unchanged.intervals);
    const MetricDerivatives metrics(bands_, arrivals_of_band(band, unchanged.arrivals), late);
    std::vector<double> rates(late.energy.size());
    for (const std::vector<Spectrum>& replicate : replicates.energy) {
        for (std::size_t interval = 0; interval < intervals; ++interval) {
            const double change =
                means[interval] > 0.0 ? replicate[interval][band] / means[interval] - 1.0 : 0.0;
            for (std::size_t bin = replicates.first_bin[interval];
                 bin < std::min(replicates.first_bin[interval + 1], rates.size());
                 ++bin) {
                rates[bin] = late.energy[bin][band] * change;
            }
        }
        deviations.push_back(vector_of(metrics.of_band(band, {.bins = rates})));
    }
    return deviations;
}

}  // namespace earshot::propagation
