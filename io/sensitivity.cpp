// SPDX-License-Identifier: MIT
#include "earshot/io/sensitivity.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/pair_head.h"

#include <optional>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;  // keys in the order of the documentation
using audio::BandMetricKind;
using audio::kBandMetricKinds;
using propagation::AbsorptionDerivatives;
using propagation::MaterialSensitivity;

Json to_json(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json to_json(std::span<const double> values) {
    return Json(std::vector<double>(values.begin(), values.end()));
}

Json energy_json(const std::string& name,
                 const propagation::MaterialEnergy& energy,
                 std::size_t bands) {
    const auto list = [&](const audio::Spectrum& spectrum) {
        return to_json(std::span(spectrum).first(bands));
    };
    return {{"name", name},
            {"before_80ms", list(energy.touched_before)},
            {"after_80ms", list(energy.touched_after)},
            {"reflections_before_80ms", list(energy.reflections_before)},
            {"reflections_after_80ms", list(energy.reflections_after)},
            {"absorbed_before_80ms", list(energy.absorbed_before)},
            {"absorbed_after_80ms", list(energy.absorbed_after)}};
}

/// A list per metric, of a list per material. `of`: the derivatives of a material or their errors.
template <typename Of>
Json derivatives_json(std::span<const MaterialSensitivity> materials, Of of) {
    Json json = Json::object();
    for (const BandMetricKind& kind : kBandMetricKinds) {
        Json rows = Json::array();
        for (const MaterialSensitivity& material : materials) {
            Json row = Json::array();
            for (const audio::BandMetrics& band : of(material).bands) {
                row.push_back(to_json(band.*kind.value));
            }
            rows.push_back(std::move(row));
        }
        json[std::string(kind.key)] = std::move(rows);
    }
    Json rows = Json::array();
    for (const MaterialSensitivity& material : materials) {
        Json row = Json::array();
        for (const std::optional<double>& number : of(material).speech_bands) {
            row.push_back(to_json(number));
        }
        rows.push_back(std::move(row));
    }
    json["sti"] = std::move(rows);
    Json single = Json::object();
    for (const BandMetricKind& kind : kBandMetricKinds) {
        Json& row = single[std::string(kind.key) + "_mid"] = Json::array();
        for (const MaterialSensitivity& material : materials) {
            row.push_back(to_json(of(material).mid.*kind.value));
        }
    }
    Json& row = single["sti"] = Json::array();
    for (const MaterialSensitivity& material : materials) {
        row.push_back(to_json(of(material).speech_transmission_index));
    }
    json["single"] = std::move(single);
    return json;
}

}  // namespace

std::string encode_sensitivity(const SensitivityHeader& header,
                               const std::vector<propagation::PairSensitivity>& pairs) {
    Json materials = Json::array();
    for (std::size_t i = 0; i < header.scene.materials.size(); ++i) {
        const audio::Spectrum absorption = header.scene.materials[i].absorption.over(header.bands);
        materials.push_back(
            {{"name", header.scene.materials[i].name},
             {"area", header.areas[i]},
             {"absorption", to_json(std::span(absorption).first(header.bands.count()))}});
    }
    JsonLines lines;
    lines.begin_list("{\"version\":1,\"scene\":" + json_text(header.scene.name) +
                         ",\"bands_hz\":" + json_text(to_json(header.bands.nominal_hz())) +
                         ",\n\"materials\":" + json_text(materials) + ",\n\"pairs\":",
                     1);
    for (const propagation::PairSensitivity& pair : pairs) {
        lines.add_record(pair_head(header.scene, pair.source, pair.listener, pair.time));
        lines.begin_list(",\"energy\":", 2);
        for (std::size_t i = 0; i < pair.materials.size(); ++i) {
            lines.add_record(json_text(energy_json(
                header.scene.materials[i].name, pair.materials[i].energy, header.bands.count())));
        }
        lines.end_list();
        const bool has_errors =
            !pair.materials.empty() && !pair.materials.front().standard_errors.bands.empty();
        lines.append(
            ",\n  \"derivatives\":" +
            json_text(derivatives_json(
                pair.materials,
                [](const MaterialSensitivity& material) -> const AbsorptionDerivatives& {
                    return material.derivatives;
                })) +
            ",\n  \"standard_error\":" +
            (has_errors
                 ? json_text(derivatives_json(
                       pair.materials,
                       [](const MaterialSensitivity& material) -> const AbsorptionDerivatives& {
                           return material.standard_errors;
                       }))
                 : "null") +
            "}");
    }
    lines.end_list();
    return lines.finish();
}

}  // namespace earshot::io
