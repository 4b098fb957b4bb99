// SPDX-License-Identifier: MIT
#include "earshot/io/internal/material_json.h"

#include "earshot/io/internal/json_lines.h"
#include "earshot/io/material_assignments.h"

#include <algorithm>
#include <string_view>

namespace earshot::io {

namespace {

using Json = nlohmann::ordered_json;
using propagation::EnergyCoefficient;
using propagation::Material;

Json coefficient_of(const EnergyCoefficient& coefficient) {
    if (coefficient.points().size() == 1) {
        return coefficient.points().front().value;
    }
    Json json = Json::object();
    for (const EnergyCoefficient::Point& point : coefficient.points()) {
        std::string frequency = json_number(point.frequency_hz);
        if (frequency.ends_with(".0")) {
            frequency.resize(frequency.size() - 2);
        }
        json[frequency] = point.value;
    }
    return json;
}

bool is_zero(const EnergyCoefficient& coefficient) {
    return std::all_of(coefficient.points().begin(),
                       coefficient.points().end(),
                       [](const EnergyCoefficient::Point& point) { return point.value == 0.0; });
}

/// A name as a shell pattern that matches it alone.
std::string pattern_of(const std::string& name) {
    std::string pattern;
    for (const char c : name) {
        pattern += std::string_view("*?[\\").find(c) != std::string_view::npos ? "\\" : "";
        pattern += c;
    }
    return pattern;
}

}  // namespace

Json material_json(const Material& material) {
    Json json = {{"absorption", coefficient_of(material.absorption)},
                 {"scattering", coefficient_of(material.scattering)}};
    if (!is_zero(material.transmission)) {
        json["transmission"] = coefficient_of(material.transmission);
    }
    if (material.one_sided) {
        json["one_sided"] = true;
    }
    return json;
}

std::string encode_materials(std::span<const Material> materials) {
    Json data = Json::object();
    for (const Material& material : materials) {
        data[pattern_of(material.name)] = material_json(material);
    }
    std::string text = "{";
    for (const auto& [pattern, value] : data.items()) {
        text +=
            (text.size() == 1 ? "\n  " : ",\n  ") + json_text(pattern) + ": " + json_text(value);
    }
    return text + "\n}\n";
}

}  // namespace earshot::io
