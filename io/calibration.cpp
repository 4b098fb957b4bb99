// SPDX-License-Identifier: MIT
#include "earshot/io/calibration.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/material_assignments.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace earshot::io {

namespace {

using Json = nlohmann::ordered_json;
using namespace propagation;

Json number_or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

/// A list with an entry per band.
template <typename Items, typename ValueOf>
Json listed(const Items& items, ValueOf value_of) {
    Json list = Json::array();
    for (const auto& item : items) {
        list.push_back(value_of(item));
    }
    return list;
}

/// `key`: of the fitted values.
Json fitted_of(const char* key, const std::vector<FittedCoefficient>& bands) {
    using Fitted = FittedCoefficient;
    return {
        {"prior", listed(bands, [](const Fitted& f) { return f.prior.mean; })},
        {"prior_error",
         listed(bands, [](const Fitted& f) { return f.prior.rate_at(f.prior.mean); })},
        {key, listed(bands, [](const Fitted& f) { return f.value; })},
        {"error", listed(bands, [](const Fitted& f) { return f.error; })},
        {"interval",
         listed(bands,
                [](const Fitted& f) {
                    return Json{f.lower, f.upper};
                })},
        {"data_error", listed(bands, [](const Fitted& f) { return number_or_null(f.data_error); })},
        {"data_share", listed(bands, [](const Fitted& f) { return f.data_share; })},
        {"fitted", listed(bands, [](const Fitted& f) { return f.is_fitted; })},
        {"identified", listed(bands, [](const Fitted& f) { return f.is_identified(); })}};
}

Json material_of(const CalibrationParts& parts, std::size_t material) {
    Json json = {{"name", parts.scene.materials[material].name}};
    json.update(fitted_of("absorption", parts.result.absorption[material]));
    if (!parts.result.scattering.empty()) {
        // Beside numbers of the same names.
        json["scattering"] = fitted_of("value", parts.result.scattering[material]);
    }
    return json;
}

Json group_of(const CalibrationParts& parts, const UnidentifiedGroup& group) {
    const auto name_of = [&](std::uint32_t material) {
        return parts.scene.materials[material].name;
    };
    Json json = {{"band_hz", parts.bands.nominal_hz()[group.band]},
                 {"materials", listed(group.materials, name_of)}};
    if (!group.scattering.empty()) {
        json["scattering"] = listed(group.scattering, name_of);
    }
    if (!group.weights.empty()) {
        json["mean"] = {
            {"weights", group.weights}, {"absorption", group.value}, {"error", group.error}};
    }
    return json;
}

Json metric_of(const CalibrationParts& parts, const CalibratedMetric& metric) {
    const MeasuredMetric& measured = metric.measured;
    return {{"source", parts.scene.sources[measured.source].name},
            {"listener", parts.scene.listeners[measured.listener].name},
            {"metric", std::string(audio::kBandMetricKinds[measured.kind].key)},
            {"band_hz", parts.bands.nominal_hz()[measured.band]},
            {"measured", measured.value},
            {"error", metric.error},
            {"before", number_or_null(metric.before)},
            {"after", number_or_null(metric.after)},
            {"model_error", metric.model_error},
            {"jnd", metric.just_noticeable_difference},
            {"weight", metric.weight}};
}

Json band_of(double band_hz, const CalibratedBand& band) {
    return {{"band_hz", band_hz},
            {"values", band.values},
            {"before_jnd", band.before},
            {"after_jnd", band.after},
            {"reduced_chi_squared", number_or_null(band.reduced_chi_squared)},
            {"converged", band.converged}};
}

}  // namespace

std::string encode_calibrated_materials(const CalibrationParts& parts) {
    const std::vector<Material> materials =
        calibrated_materials(parts.scene, parts.result, parts.bands);
    std::vector<Material> written;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const auto has_fit = [&](const std::vector<std::vector<FittedCoefficient>>& coefficients) {
            return !coefficients.empty() && std::any_of(coefficients[i].begin(),
                                                        coefficients[i].end(),
                                                        [](const auto& f) { return f.is_fitted; });
        };
        const bool is_fitted = has_fit(parts.result.absorption) || has_fit(parts.result.scattering);
        const bool is_default =
            std::find(parts.default_materials.begin(), parts.default_materials.end(), i) !=
            parts.default_materials.end();
        if (is_fitted || !is_default) {
            written.push_back(materials[i]);
        }
    }
    return encode_materials(written);
}

std::string encode_calibration(const CalibrationParts& parts) {
    const CalibrationResult& result = parts.result;
    std::vector<double> bands_hz(parts.bands.nominal_hz().begin(), parts.bands.nominal_hz().end());
    JsonLines lines;
    std::string head = json_text(Json{{"version", 1},
                                      {"scene", parts.scene.name},
                                      {"bands_hz", bands_hz},
                                      {"simulations", result.simulations},
                                      {"rays", result.rays},
                                      {"converged", result.converged}});
    head.pop_back();
    lines.append(head);
    const auto add_list = [&](const char* name, const auto& items, auto record_of) {
        Json records = Json::array();
        for (std::size_t i = 0; i < items.size(); ++i) {
            records.push_back(record_of(i));
        }
        lines.add_list(name, records);
    };
    add_list("bands", result.bands, [&](std::size_t i) {
        return band_of(bands_hz[i], result.bands[i]);
    });
    add_list("materials", result.absorption, [&](std::size_t i) { return material_of(parts, i); });
    add_list(
        "groups", result.groups, [&](std::size_t i) { return group_of(parts, result.groups[i]); });
    add_list("metrics", result.metrics, [&](std::size_t i) {
        return metric_of(parts, result.metrics[i]);
    });
    add_list("warnings", result.warnings, [&](std::size_t i) {
        return Json{{"subject", result.warnings[i].subject}, {"text", result.warnings[i].what}};
    });
    return lines.finish();
}

}  // namespace earshot::io
