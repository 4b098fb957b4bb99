// SPDX-License-Identifier: MIT
#include "earshot/base/spelling.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/propagation/material.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::cli {
namespace {

using propagation::EnergyCoefficient;
using propagation::LibraryMaterial;
using Json = nlohmann::ordered_json;

// The octaves that nearly all literature gives.
constexpr std::array<double, 7> kColumnsHz = {125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0};

// Nominal band centres print as 31.5, 125, 8000.
std::string frequency_text(double frequency_hz) {
    return formatted("%g", frequency_hz);
}

std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(width, text.size()), ' ');
    return text;
}

std::string columns_header() {
    std::string line;
    for (const double frequency_hz : kColumnsHz) {
        const std::string text = frequency_text(frequency_hz);
        line += std::string(6 - std::min<std::size_t>(5, text.size()), ' ') + text;
    }
    return line;
}

std::string cell(double value) {
    return formatted("%6.2f", value);
}

std::string columns(const EnergyCoefficient& coefficient) {
    std::string line;
    for (const double frequency_hz : kColumnsHz) {
        line += cell(coefficient.at(frequency_hz));
    }
    return line;
}

std::string table(std::span<const LibraryMaterial> rows) {
    std::size_t width = 0;
    for (const LibraryMaterial& row : rows) {
        width = std::max(width, row.name.size());
    }
    std::string text =
        "Energy absorption coefficients per octave (Hz), and scattering coefficients at 1 kHz:\n\n";
    text += std::string(width, ' ') + columns_header() + "  scat.\n";
    for (const LibraryMaterial& row : rows) {
        text += padded(std::string(row.name), width) + columns(row.material.absorption) + " " +
                cell(row.material.scattering.at(1000.0)) +
                (row.scattering_source.starts_with("estimate") ? "*  " : "   ") +
                std::string(row.description) + "\n";
    }
    text += "\n" + std::to_string(rows.size()) +
            " materials; * estimate. earshot materials NAME gives all coefficients of one, with "
            "sources.\n";
    return text;
}

std::string description(const LibraryMaterial& row) {
    const std::string name(row.name);
    std::string text = name + ": " + std::string(row.description) + "\n";
    text += "Source: " + std::string(row.source) + "\n";
    text += "Scattering: " + std::string(row.scattering_source) + "\n\n";
    text += "Hz          " + columns_header() + "\n";
    text += "absorption  " + columns(row.material.absorption) + "\n";
    text += "scattering  " + columns(row.material.scattering) + "\n";
    text += "transmission" + columns(row.material.transmission) + "\n\n";
    text += "In a glTF material: \"extras\": {\"acoustics\": {\"library\": \"" + name + "\"}}\n";
    return text;
}

Json to_json(const EnergyCoefficient& coefficient) {
    Json points = Json::object();
    for (const EnergyCoefficient::Point& point : coefficient.points()) {
        points[frequency_text(point.frequency_hz)] = point.value;
    }
    return points;
}

std::string json_text(std::span<const LibraryMaterial> rows) {
    Json materials = Json::array();
    for (const LibraryMaterial& row : rows) {
        materials.push_back({{"name", row.name},
                             {"description", row.description},
                             {"source", row.source},
                             {"scattering_source", row.scattering_source},
                             {"absorption", to_json(row.material.absorption)},
                             {"scattering", to_json(row.material.scattering)},
                             {"transmission", to_json(row.material.transmission)}});
    }
    return Json{{"version", 1}, {"materials", materials}}.dump(1) + "\n";
}

class MaterialsCommand : public Command {
public:
    explicit MaterialsCommand(CLI::App& program)
        : Command(program,
                  "materials",
                  "List the built-in library of acoustic materials",
                  {.threads = false, .simd = false}) {
        app()
            .add_option(
                "NAME",
                name_,
                "show only this material, with its sources, or all whose names contain this")
            ->type_name("");
        app().footer(
            "Examples:\n"
            "  earshot materials                  the whole table\n"
            "  earshot materials brick-painted    one material and where its numbers come from\n"
            "  earshot materials curtain          all whose names contain the word\n"
            "  earshot materials --json           for a program\n\n"
            "A glTF material refers to one by its own name, or by\n"
            "  \"extras\": {\"acoustics\": {\"library\": \"brick-painted\"}}");
    }

    void run() override {
        const std::vector<LibraryMaterial> rows = chosen_rows();
        if (common().json) {
            write_output(json_text(rows));
        } else {
            write_output(rows.size() == 1 ? description(rows.front()) : table(rows));
        }
    }

private:
    // All rows, the named one, or those whose names contain the name.
    std::vector<LibraryMaterial> chosen_rows() {
        std::vector<LibraryMaterial> chosen;
        std::vector<std::string> names;
        for (const LibraryMaterial& row : propagation::material_library()) {
            if (row.name == name_) {
                return {row};
            }
            if (row.name.find(name_) != std::string_view::npos) {
                chosen.push_back(row);
            }
            names.emplace_back(row.name);
        }
        if (chosen.empty()) {
            throw UsageError(name_,
                             "no such material in the library",
                             did_you_mean(name_, names, "see earshot materials"));
        }
        return chosen;
    }

    std::string name_;
};

}  // namespace

std::unique_ptr<Command> make_materials_command(CLI::App& program) {
    return std::make_unique<MaterialsCommand>(program);
}

}  // namespace earshot::cli
