// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/calibration_object.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/simulation_options.h"
#include "earshot/capi/internal/work.h"
#include "earshot/io/calibration.h"
#include "earshot/io/measured_responses.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

namespace earshot::capi {

namespace {

using propagation::CalibratedMetric;
using propagation::FittedCoefficient;
using propagation::MeasuredMetric;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxFactor = 1e3;

// Those of `earshot calibrate`.
constexpr es_calibration_options kDefaults = {.struct_size = sizeof(es_calibration_options),
                                              .default_error = 0.5,
                                              .spread = 1.0,
                                              .max_simulations = 5,
                                              .noise_free = 0,
                                              .unknown_materials = nullptr,
                                              .unknown_count = 0,
                                              .kept_materials = nullptr,
                                              .kept_count = 0,
                                              .measured = nullptr,
                                              .metrics = nullptr,
                                              .reference_db = kNone,
                                              .fit_scattering = 0,
                                              .reserved = 0};

es_calibration_options checked(const es_calibration_options* options) {
    if (options == nullptr) {
        return kDefaults;
    }
    const es_calibration_options whole =
        require_struct(*options, kDefaults, sizeof(es_calibration_options), "options");
    constexpr std::int64_t kMaxSimulations = 50;
    constexpr double kMaxLevel = 1e3;
    require_in(whole.default_error, 1.0 / kMaxFactor, kMaxFactor, "options->default_error");
    require_in(whole.spread, 1.0 / kMaxFactor, kMaxFactor, "options->spread");
    require_in(std::int64_t{whole.max_simulations}, 1, kMaxSimulations, "options->max_simulations");
    require_flag(whole.noise_free, "options->noise_free");
    require_flag(whole.fit_scattering, "options->fit_scattering");
    require_in(std::int64_t{whole.reserved}, 0, 0, "options->reserved");
    if (!std::isnan(whole.reference_db)) {
        require_in(whole.reference_db, -kMaxLevel, kMaxLevel, "options->reference_db");
    }
    return whole;
}

std::vector<std::uint32_t> materials_of(const std::uint32_t* materials,
                                        std::size_t count,
                                        std::size_t material_count,
                                        const char* argument) {
    const auto list = require_array(materials, count, argument);
    for (const std::uint32_t material : list) {
        require_index(material, material_count, argument);
    }
    return {list.begin(), list.end()};
}

constexpr double kRaysError = 0.01;  // of T30, without options

std::vector<MeasuredMetric> measured_of(std::span<const es_measured_metric> given,
                                        const propagation::Scene& scene,
                                        const audio::Bands& bands) {
    constexpr double kMaxValue = 1e6;
    std::vector<MeasuredMetric> measured;
    for (const es_measured_metric& value : given) {
        require_index(value.source, scene.sources.size(), "measured->source");
        require_index(value.listener, scene.listeners.size(), "measured->listener");
        require_in(std::int64_t{value.metric}, ES_METRIC_EDT, ES_METRIC_G, "measured->metric");
        require_in(std::int64_t{value.reserved}, 0, 0, "measured->reserved");
        require_in(value.value, -kMaxValue, kMaxValue, "measured->value");
        require_in(value.error, 0.0, kMaxValue, "measured->error");
        const auto nominal = bands.nominal_hz();
        const auto band = std::find(nominal.begin(), nominal.end(), value.band_hz);
        if (band == nominal.end()) {
            fail_argument("measured->band_hz",
                          "is not the nominal frequency of a band",
                          "give one of es_bands_nominal()");
        }
        measured.push_back({.source = value.source,
                            .listener = value.listener,
                            .kind = static_cast<std::size_t>(value.metric),
                            .band = static_cast<std::size_t>(band - nominal.begin()),
                            .value = value.value});
        if (value.error > 0.0) {
            measured.back().error = value.error;
        }
    }
    return measured;
}

io::MeasuredMetrics read_files(const es_calibration_options& options,
                               const propagation::Scene& scene,
                               const audio::Bands& bands) {
    const bool is_calibrated = !std::isnan(options.reference_db);
    io::MeasuredResponseOptions reading = {.bands = bands, .noise_free = options.noise_free != 0};
    if (is_calibrated) {
        reading.strength_correction_db =
            audio::StrengthCorrection(bands.count(), -options.reference_db);
    }
    reading.kinds = io::parse_metric_keys(text_or(
        options.metrics, is_calibrated ? "edt,t30,c80,g" : "edt,t30,c80", "options->metrics"));
    return io::read_measured(std::string(require_text(options.measured, "options->measured")),
                             scene,
                             reading,
                             options.metrics != nullptr);
}

double number_of(const FittedCoefficient& fitted, std::size_t table) {
    switch (table) {
        case ES_CALIBRATION_PRIOR:
            return fitted.prior.mean;
        case ES_CALIBRATION_PRIOR_ERROR:
            return fitted.prior.rate_at(fitted.prior.mean);
        case ES_CALIBRATION_ABSORPTION:
            return fitted.value;
        case ES_CALIBRATION_ERROR:
            return fitted.error;
        case ES_CALIBRATION_LOWER:
            return fitted.lower;
        case ES_CALIBRATION_UPPER:
            return fitted.upper;
        case ES_CALIBRATION_DATA_ERROR:
            return fitted.data_error.value_or(kNone);
        case ES_CALIBRATION_DATA_SHARE:
            return fitted.data_share;
        default:
            return fitted.is_identified() ? 1.0 : 0.0;
    }
}

es_calibration_info info_of(const propagation::CalibrationResult& result) {
    es_calibration_info info{};
    info.materials = result.absorption.size();
    info.bands = result.bands.size();
    info.metrics = result.metrics.size();
    info.rays = result.rays;
    info.simulations = result.simulations;
    info.converged = result.converged ? 1 : 0;
    return info;
}

}  // namespace

CalibrationObject::CalibrationObject(propagation::CalibrationResult calibration)
    : result(std::move(calibration)) {
    constexpr std::size_t kTablesEach = ES_CALIBRATION_SCATTERING_PRIOR;
    is_fitted.resize(result.absorption.size());
    const auto add = [&](const std::vector<std::vector<FittedCoefficient>>& coefficients,
                         std::size_t first_table) {
        for (std::size_t material = 0; material < coefficients.size(); ++material) {
            for (const FittedCoefficient& band : coefficients[material]) {
                is_fitted[material] = is_fitted[material] || band.is_fitted;
                for (std::size_t table = 0; table < kTablesEach; ++table) {
                    tables[first_table + table].push_back(number_of(band, table));
                }
            }
        }
    };
    add(result.absorption, ES_CALIBRATION_PRIOR);
    add(result.scattering, ES_CALIBRATION_SCATTERING_PRIOR);
    for (const CalibratedMetric& metric : result.metrics) {
        measured.push_back(metric.measured.value);
        before.push_back(metric.before.value_or(kNone));
        after.push_back(metric.after.value_or(kNone));
        weights.push_back(metric.weight);
    }
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_calibration_options_init(es_calibration_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kDefaults, options, size, sizeof(es_calibration_options)); });
}

es_status es_calibrate(es_scene scene,
                       const es_simulation_options* simulation,
                       const es_calibration_options* options,
                       const es_measured_metric* measured,
                       size_t count,
                       es_calibration* calibration) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(calibration, "calibration");
        const io::LoadedScene& loaded = object->loaded;
        const std::size_t material_count = loaded.scene.materials.size();
        const es_simulation_options given = checked_options_or(simulation, kRaysError);
        const es_calibration_options whole = checked(options);
        propagation::CalibrationOptions fit = {
            .simulation = simulator_options(given),
            .time = given.time,
            .default_error = whole.default_error,
            .prior_deviation = whole.spread,
            .fit_scattering = whole.fit_scattering != 0,
            .unknown_materials = materials_of(whole.unknown_materials,
                                              whole.unknown_count,
                                              material_count,
                                              "options->unknown_materials"),
            .fixed_materials = materials_of(
                whole.kept_materials, whole.kept_count, material_count, "options->kept_materials"),
            .max_simulations = whole.max_simulations};
        fit.simulation.late_length = 0.0;
        fit.unknown_materials.insert(fit.unknown_materials.end(),
                                     loaded.default_materials.begin(),
                                     loaded.default_materials.end());
        const audio::Bands& bands = fit.simulation.bands;
        const auto values = require_array(measured, count, "measured");
        io::MeasuredMetrics read;
        if (values.empty()) {
            read = read_files(whole, loaded.scene, bands);
        } else {
            read.values = measured_of(values, loaded.scene, bands);
        }
        Executor executor(given.threads);
        CallbackProgress progress(given.progress, given.progress_data);
        auto made = std::make_shared<CalibrationObject>(
            propagation::calibrate_materials(loaded.scene, read.values, fit, executor, &progress));
        const io::CalibrationParts parts = {.scene = loaded.scene,
                                            .bands = bands,
                                            .result = made->result,
                                            .default_materials = loaded.default_materials};
        made->materials = propagation::calibrated_materials(loaded.scene, made->result, bands);
        made->json = io::encode_calibration(parts);
        made->materials_file = io::encode_calibrated_materials(parts);
        made->warnings = std::move(read.warnings);
        made->warnings.insert(
            made->warnings.end(), made->result.warnings.begin(), made->result.warnings.end());
        *calibration = publish(std::move(made));
    });
}

es_status es_calibration_get_info(es_calibration calibration, es_calibration_info* info) {
    return call(__func__, [&] {
        const Reading<CalibrationObject> object(calibration, "calibration");
        give_struct(info_of(object->result), info, sizeof(es_calibration_info), "info");
    });
}

es_status es_calibration_values(es_calibration calibration,
                                int32_t table,
                                const double** values,
                                size_t shape[2]) {
    return call(__func__, [&] {
        const Reading<CalibrationObject> object(calibration, "calibration");
        require_in(std::int64_t{table},
                   ES_CALIBRATION_PRIOR,
                   ES_CALIBRATION_SCATTERING_IDENTIFIED,
                   "table");
        if (table >= ES_CALIBRATION_SCATTERING_PRIOR && object->result.scattering.empty()) {
            fail_argument(
                "table", "is of scattering, which was not fitted", "set options->fit_scattering");
        }
        require(values, "values") = object->tables[static_cast<std::size_t>(table)].data();
        require(shape, "shape");
        shape[0] = object->result.absorption.size();
        shape[1] = object->result.bands.size();
    });
}

es_status es_calibration_metrics(es_calibration calibration,
                                 const double** measured,
                                 const double** before,
                                 const double** after,
                                 const double** weights,
                                 size_t* count) {
    return call(__func__, [&] {
        const Reading<CalibrationObject> object(calibration, "calibration");
        require(count, "count") = object->measured.size();
        const auto give = [](const std::vector<double>& numbers, const double** out) {
            if (out != nullptr) {
                *out = numbers.data();
            }
        };
        give(object->measured, measured);
        give(object->before, before);
        give(object->after, after);
        give(object->weights, weights);
    });
}

es_status es_calibration_warnings(es_calibration calibration, es_messages* messages) {
    return call(__func__, [&] {
        const Reading<CalibrationObject> object(calibration, "calibration");
        require(messages, "messages") = publish_messages(object->warnings);
    });
}

es_status es_calibration_json(es_calibration calibration, const char** text) {
    return call(__func__, [&] {
        const Reading<CalibrationObject> object(calibration, "calibration");
        require(text, "text") = object->json.c_str();
    });
}

es_status es_calibration_write(es_calibration calibration, const char* file) {
    return call(__func__, [&] {
        const Reading<CalibrationObject> object(calibration, "calibration");
        io::write_whole_file(std::string(require_text(file, "file")), object->materials_file);
    });
}

es_status es_calibration_apply(es_calibration calibration, es_scene scene) {
    return call(__func__, [&] {
        const Reading<CalibrationObject> object(calibration, "calibration");
        const Changing<SceneObject> target(scene, "scene");
        std::vector<propagation::Material>& materials = target->loaded.scene.materials;
        if (materials.size() != object->materials.size()) {
            fail_argument("scene",
                          "has " + std::to_string(materials.size()) + " materials, not " +
                              std::to_string(object->materials.size()),
                          "give the scene that was calibrated");
        }
        for (std::size_t i = 0; i < materials.size(); ++i) {
            if (object->is_fitted[i]) {
                materials[i].absorption = object->materials[i].absorption;
                materials[i].transmission = object->materials[i].transmission;
                materials[i].scattering = object->materials[i].scattering;
                std::erase(target->loaded.default_materials, static_cast<std::uint32_t>(i));
            }
        }
    });
}
