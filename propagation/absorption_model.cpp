// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/absorption_model.h"

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

AbsorptionModel::AbsorptionModel(const Scene& scene, PairResult pair, const audio::Bands& bands)
    : bands_(bands),
      materials_(scene.materials.size()),
      pair_(std::make_unique<const PairResult>(std::move(pair))),
      energies_(scene, *pair_) {
    for (const Material& material : scene.materials) {
        absorption_.push_back(material.absorption.over(bands));
    }
    const LateMaterials& late = energies_.materials();
    mean_reflections_.resize(late.intervals() * materials_ * bands.count());
    for (std::size_t interval = 0; interval < late.intervals(); ++interval) {
        for (std::size_t cell = 0; cell < materials_ * bands.count(); ++cell) {
            mean_reflections_[interval * materials_ * bands.count() + cell] =
                energies_.mean_of(energies_.whole().reflections,
                                  energies_.whole(),
                                  late.first_bin[interval],
                                  cell / bands.count(),
                                  cell % bands.count());
        }
    }
}

AbsorptionModel::Factors AbsorptionModel::factors(std::size_t band,
                                                  std::span<const double> absorption) const {
    std::vector<double> logs(materials_, 0.0);
    for (std::size_t material = 0; material < materials_; ++material) {
        const double before = absorption_[material][band];
        if (absorption[material] != before) {
            EARSHOT_ASSERT(before < 1.0 && absorption[material] < 1.0);
            logs[material] = math::log((1.0 - absorption[material]) / (1.0 - before));
        }
    }
    Factors result;
    for (std::size_t i = 0; i < energies_.arrivals().size(); ++i) {
        double sum = 0.0;
        for (std::size_t material = 0; material < materials_; ++material) {
            sum += energies_.reflections_of_path(i, material) * logs[material];
        }
        result.arrivals.push_back(math::exp(sum));
    }
    for (std::size_t interval = 0; interval < energies_.materials().intervals(); ++interval) {
        double sum = 0.0;
        for (std::size_t material = 0; material < materials_; ++material) {
            sum += mean_reflections(interval, material, band) * logs[material];
        }
        result.intervals.push_back(math::exp(sum));
    }
    return result;
}

std::vector<Arrival> AbsorptionModel::arrivals_of_band(std::size_t band,
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

EnergyHistogram AbsorptionModel::late_of_band(std::size_t band,
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

ModelledMetrics AbsorptionModel::evaluate(std::size_t band,
                                          std::span<const double> absorption) const {
    EARSHOT_ASSERT(absorption.size() == materials_);
    const Factors changes = factors(band, absorption);
    const std::vector<Arrival> arrivals = arrivals_of_band(band, changes.arrivals);
    const EnergyHistogram late = late_of_band(band, changes.intervals);
    const MetricDerivatives metrics(bands_, arrivals, late);
    ModelledMetrics result;
    for (std::size_t kind = 0; kind < kMetricCount; ++kind) {
        result.values[kind] = metrics.metrics().bands.at(band).*audio::kBandMetricKinds[kind].value;
    }
    std::vector<double> of_arrivals(arrivals.size()), of_bins(late.energy.size());
    for (std::size_t material = 0; material < materials_; ++material) {
        const double kept = 1.0 - absorption[material];
        if (!(kept > 0.0)) {
            result.derivatives.emplace_back();
            continue;
        }
        for (std::size_t i = 0; i < arrivals.size(); ++i) {
            const double pressure = arrivals[i].pressure[band];
            of_arrivals[i] =
                -energies_.reflections_of_path(i, material) * (pressure * pressure) / kept;
        }
        for (std::size_t bin = 0; bin < of_bins.size(); ++bin) {
            of_bins[bin] = -mean_reflections(energies_.interval_of_bin(bin), material, band) *
                           late.energy[bin][band] / kept;
        }
        result.derivatives.push_back(
            vector_of(metrics.of_band(band, {.arrivals = of_arrivals, .bins = of_bins})));
    }
    return result;
}

std::vector<MetricVector> AbsorptionModel::ray_deviations(std::size_t band) const {
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
