// SPDX-License-Identifier: MIT
// Which surfaces matter, as flat arrays.
#include "earshot/audio/room_metrics.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/metric_kinds.h"
#include "earshot/capi/internal/result_object.h"

#include <limits>

namespace earshot::capi {
namespace {

using propagation::AbsorptionDerivatives;
using propagation::MaterialEnergy;
using propagation::MaterialSensitivity;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// (sources, listeners, materials, bands) of one quantity.
std::vector<double> packed(const ResultObject& result, audio::Spectrum MaterialEnergy::*quantity) {
    std::vector<double> values;
    for (const propagation::PairSensitivity& pair : result.sensitivity) {
        for (const MaterialSensitivity& material : pair.materials) {
            const audio::Spectrum& spectrum = material.energy.*quantity;
            values.insert(values.end(),
                          spectrum.begin(),
                          spectrum.begin() + static_cast<std::ptrdiff_t>(result.info.bands));
        }
    }
    return values;
}

/// A derivative or its standard error, which may be missing.
void append(const AbsorptionDerivatives& of,
            std::size_t metric,
            std::int32_t form,
            std::size_t bands,
            std::vector<double>& values) {
    const bool is_index = metric == ES_METRIC_STI;
    const auto kind = is_index ? nullptr : audio::kBandMetricKinds[metric].value;
    if (form == ES_SINGLE_NUMBER) {
        const auto& number = is_index ? of.speech_transmission_index : of.mid.*kind;
        values.push_back(number.value_or(kNoValue));
        return;
    }
    for (std::size_t band = 0; band < bands; ++band) {
        const bool is_there = band < of.bands.size();
        const std::optional<double> number = !is_there  ? std::nullopt
                                             : is_index ? of.speech_bands[band]
                                                        : of.bands[band].*kind;
        values.push_back(number.value_or(kNoValue));
    }
}

}  // namespace

void require_sensitivity(const ResultObject& result) {
    if (result.sensitivity.empty()) {
        throw Error("sensitivity",
                    "was not asked for",
                    "simulate with es_simulation_options::sensitivity = 1");
    }
}

void ResultObject::flatten_sensitivity() {
    if (sensitivity.empty()) {
        return;
    }
    constexpr std::array kQuantities = {&MaterialEnergy::touched_before,
                                        &MaterialEnergy::touched_after,
                                        &MaterialEnergy::reflections_before,
                                        &MaterialEnergy::reflections_after,
                                        &MaterialEnergy::absorbed_before,
                                        &MaterialEnergy::absorbed_after};
    for (std::size_t i = 0; i < kQuantities.size(); ++i) {
        material_energies[i] = packed(*this, kQuantities[i]);
    }
    for (std::size_t metric = 0; metric < derivative_tables.size(); ++metric) {
        for (const std::int32_t form : {ES_PER_BAND, ES_SINGLE_NUMBER}) {
            MetricTable& table = derivative_tables[metric][static_cast<std::size_t>(form)];
            for (const propagation::PairSensitivity& pair : sensitivity) {
                for (const MaterialSensitivity& material : pair.materials) {
                    append(material.derivatives, metric, form, info.bands, table.values);
                    append(material.standard_errors, metric, form, info.bands, table.errors);
                }
            }
        }
    }
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_result_sensitivity(es_result result, es_sensitivity* sensitivity) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require_sensitivity(*object);
        give_struct({.struct_size = 0,
                     .areas = object->material_areas.data(),
                     .touched_before = object->material_energies[0].data(),
                     .touched_after = object->material_energies[1].data(),
                     .reflections_before = object->material_energies[2].data(),
                     .reflections_after = object->material_energies[3].data(),
                     .absorbed_before = object->material_energies[4].data(),
                     .absorbed_after = object->material_energies[5].data(),
                     .material_count = object->names.materials.size(),
                     .band_count = object->info.bands},
                    sensitivity,
                    sizeof(es_sensitivity),
                    "sensitivity");
    });
}

es_status es_result_derivative(es_result result,
                               int32_t metric,
                               int32_t form,
                               const double** values,
                               const double** standard_errors,
                               size_t shape[4]) {
    return call(__func__, [&] {
        const Reading<ResultObject> object(result, "result");
        require(values, "values");
        require(shape, "shape");
        require_in(std::int64_t{metric}, ES_METRIC_EDT, ES_METRIC_STI, "metric");
        require_in(std::int64_t{form}, ES_PER_BAND, ES_SINGLE_NUMBER, "form");
        require_sensitivity(*object);
        const MetricTable& table = object->derivative_tables[static_cast<std::size_t>(metric)]
                                                            [static_cast<std::size_t>(form)];
        *values = table.values.data();
        if (standard_errors != nullptr) {
            *standard_errors = table.errors.data();
        }
        shape[0] = object->info.sources;
        shape[1] = object->info.listeners;
        shape[2] = object->names.materials.size();
        shape[3] = form == ES_PER_BAND ? object->info.bands : 1;
    });
}
