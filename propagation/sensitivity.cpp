// SPDX-License-Identifier: MIT
#include "earshot/propagation/sensitivity.h"

#include "earshot/audio/metric_derivatives.h"
#include "earshot/base/assert.h"
#include "earshot/base/standard_error.h"
#include "earshot/propagation/internal/pair_energies.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::propagation {

namespace {

using audio::BandMetrics;
using audio::EnergyHistogram;
using audio::EnergyRates;
using audio::MetricDerivatives;
using audio::Spectrum;

/// Splits energy at an instant.
class EarlyAndLate {
public:
    explicit EarlyAndLate(double limit) : limit_(limit) {}

    void add(double begin, double end, double energy, double touched, double reflected) {
        const double share = end > begin ? std::clamp((limit_ - begin) / (end - begin), 0.0, 1.0)
                                         : (begin < limit_ ? 1.0 : 0.0);
        for (std::size_t i = 0; i < 3; ++i) {
            const double number = i == 0 ? energy : i == 1 ? touched : reflected;
            before_[i] += share * number;
            after_[i] += (1.0 - share) * number;
        }
    }

    void read(std::size_t band, MaterialEnergy& out) const {
        const auto over = [](double sum, double energy) {
            return energy > 0.0 ? sum / energy : 0.0;
        };
        out.touched_before[band] = over(before_[1], before_[0]);
        out.touched_after[band] = over(after_[1], after_[0]);
        out.reflections_before[band] = over(before_[2], before_[0]);
        out.reflections_after[band] = over(after_[2], after_[0]);
    }

private:
    double limit_;  // seconds
    double before_[3] = {}, after_[3] = {};
};

/// In one band, whose sound sets in at `onset`.
void read_energy(const PairEnergies& energies,
                 std::size_t material,
                 std::size_t band,
                 double onset,
                 MaterialEnergy& out) {
    EarlyAndLate sums(onset + kEarlyLimit);
    for (std::size_t i = 0; i < energies.arrivals().size(); ++i) {
        const audio::Arrival& arrival = energies.arrivals()[i];
        const double energy = arrival.pressure[band] * arrival.pressure[band];
        const double reflections = energies.reflections_of_path(i, material);
        sums.add(arrival.delay,
                 arrival.delay,
                 energy,
                 reflections > 0.0 ? energy : 0.0,
                 reflections * energy);
    }
    const EnergyHistogram& late = energies.late();
    const LateMaterials& materials = energies.materials();
    for (std::size_t bin = 0; bin < late.energy.size(); ++bin) {
        const double begin = static_cast<double>(bin) * late.bin;
        const double energy = late.energy[bin][band];
        const auto mean_of = [&](std::span<const double> numbers) {
            return energies.mean_of(numbers, energies.whole(), bin, material, band);
        };
        sums.add(begin,
                 begin + late.bin,
                 energy,
                 energy * mean_of(materials.touched),
                 energy * mean_of(energies.whole().reflections));
    }
    sums.read(band, out);
    if (!materials.absorbed.empty()) {
        const std::size_t cell = material * materials.bands + band;
        out.absorbed_before[band] = materials.absorbed[cell];
        out.absorbed_after[band] = materials.absorbed[materials.materials * materials.bands + cell];
    }
}

/// Derivatives by the absorption of each material, of the late energy as `rays` have it.
std::vector<AbsorptionDerivatives> derivatives_of(const Scene& scene,
                                                  const audio::Bands& bands,
                                                  const PairEnergies& energies,
                                                  const MetricDerivatives& metrics,
                                                  const LateMaterials::Part& rays,
                                                  const EnergyHistogram& late) {
    std::vector<AbsorptionDerivatives> result;
    for (std::size_t material = 0; material < scene.materials.size(); ++material) {
        const Spectrum absorption = scene.materials[material].absorption.over(bands);
        AbsorptionDerivatives& out = result.emplace_back();
        bool is_complete = true;
        double speech = 0.0;
        for (std::size_t band = 0; band < bands.count(); ++band) {
            const double kept = 1.0 - absorption[band];
            if (!(kept > 0.0)) {
                out.bands.emplace_back();
                out.speech_bands.emplace_back();
                is_complete = false;
                continue;
            }
            // Each reflection stands with a factor 1 - absorption.
            Reflections rates = energies.reflections(material, band, rays, late);
            for (std::vector<double>* numbers : {&rates.arrivals, &rates.bins}) {
                for (double& number : *numbers) {
                    number /= -kept;
                }
            }
            const EnergyRates energy_rates = {.arrivals = rates.arrivals, .bins = rates.bins};
            out.bands.push_back(metrics.of_band(band, energy_rates));
            out.speech_bands.push_back(metrics.of_speech(band, energy_rates));
            speech += out.speech_bands.back().value_or(0.0);
        }
        out.mid = audio::mid_frequency_means(bands, out.bands);
        if (is_complete && metrics.metrics().speech_transmission_index) {
            out.speech_transmission_index = speech;
        }
    }
    return result;
}

/// Standard errors by the jackknife, of numbers without each part.
class Errors {
public:
    explicit Errors(std::span<const std::vector<AbsorptionDerivatives>> without)
        : without_(without) {}

    AbsorptionDerivatives of(std::size_t material, const AbsorptionDerivatives& values) const {
        AbsorptionDerivatives errors;
        for (std::size_t band = 0; band < values.bands.size(); ++band) {
            errors.bands.push_back(
                of_metrics(values.bands[band], [&](const auto& part) -> const BandMetrics& {
                    return part[material].bands[band];
                }));
            errors.speech_bands.push_back(
                of_number(values.speech_bands[band],
                          [&](const auto& part) { return part[material].speech_bands[band]; }));
        }
        errors.mid = of_metrics(
            values.mid, [&](const auto& part) -> const BandMetrics& { return part[material].mid; });
        errors.speech_transmission_index =
            of_number(values.speech_transmission_index,
                      [&](const auto& part) { return part[material].speech_transmission_index; });
        return errors;
    }

private:
    template <typename NumberOf>
    std::optional<double> of_number(const std::optional<double>& value, NumberOf number_of) const {
        if (!value) {
            return std::nullopt;
        }
        std::vector<double> numbers;
        for (const auto& part : without_) {
            numbers.push_back(number_of(part).value_or(*value));
        }
        return static_cast<double>(numbers.size() - 1) * standard_error_of_mean(numbers);
    }

    template <typename MetricsOf>
    BandMetrics of_metrics(const BandMetrics& values, MetricsOf metrics_of) const {
        BandMetrics errors;
        for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
            errors.*kind.value = of_number(
                values.*kind.value, [&](const auto& part) { return metrics_of(part).*kind.value; });
        }
        return errors;
    }

    std::span<const std::vector<AbsorptionDerivatives>> without_;
};

void check(const Scene& scene, const PairResult& pair, const SensitivityOptions& options) {
    require_materials(pair, "sensitivity");
    [[maybe_unused]] const LateMaterials& late = pair.late_materials;
    EARSHOT_ASSERT(pair.late.energy.empty() || (late.bands == options.bands.count() &&
                                                late.materials == scene.materials.size()));
}

}  // namespace

PairSensitivity pair_sensitivity(const Scene& scene,
                                 const PairResult& pair,
                                 const SensitivityOptions& options) {
    check(scene, pair, options);
    const PairEnergies energies(scene, pair);
    const MetricDerivatives metrics(options.bands, energies.arrivals(), pair.late, options.speech);
    PairSensitivity result = {
        .source = pair.source,
        .listener = pair.listener,
        .time = pair.time,
        .metrics = metrics.metrics(),
        .materials = std::vector<MaterialSensitivity>(scene.materials.size())};
    const std::vector<AbsorptionDerivatives> derivatives =
        derivatives_of(scene, options.bands, energies, metrics, energies.whole(), pair.late);
    for (std::size_t material = 0; material < scene.materials.size(); ++material) {
        result.materials[material].derivatives = derivatives[material];
        for (std::size_t band = 0; band < options.bands.count(); ++band) {
            read_energy(
                energies, material, band, metrics.onset(band), result.materials[material].energy);
        }
    }
    if (!options.report_errors || pair.late_materials.parts.size() < 2) {
        return result;
    }
    std::vector<std::vector<AbsorptionDerivatives>> without;
    for (const LateMaterials::Part& part : pair.late_materials.parts) {
        const LateMaterials::Part rest = energies.without(part);
        const EnergyHistogram late = energies.late_of(rest);
        const MetricDerivatives of_rest(options.bands, energies.arrivals(), late, options.speech);
        without.push_back(derivatives_of(scene, options.bands, energies, of_rest, rest, late));
    }
    const Errors errors(without);
    for (std::size_t material = 0; material < scene.materials.size(); ++material) {
        result.materials[material].standard_errors = errors.of(material, derivatives[material]);
    }
    return result;
}

std::vector<double> material_areas(const Scene& scene, double time) {
    const std::vector<geometry::Vec3> positions = scene.mesh.positions_at(time);
    std::vector<double> areas(scene.materials.size());
    for (std::size_t i = 0; i < scene.mesh.triangles().size(); ++i) {
        const geometry::Triangle& triangle = scene.mesh.triangles()[i];
        const geometry::Vec3& a = positions[triangle[0]];
        areas[scene.material_of_triangle[i]] +=
            0.5 * glm::length(glm::cross(positions[triangle[1]] - a, positions[triangle[2]] - a));
    }
    return areas;
}

}  // namespace earshot::propagation
