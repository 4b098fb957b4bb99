// SPDX-License-Identifier: MIT
#include "earshot/base/spelling.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/propagation/material.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string>
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
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%g", frequency_hz);
    return text.data();
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

std::string columns(const EnergyCoefficient& coefficient) {
    std::string line;
    for (const double frequency_hz : kColumnsHz) {
        std::array<char, 16> cell{};
        std::snprintf(cell.data(), cell.size(), "%6.2f", coefficient.at(frequency_hz));
        line += cell.data();
    }
    return line;
}

std::string table(std::span<const LibraryMaterial> rows) {
    std::size_t width = 0;
    for (const LibraryMaterial& row : rows) {
        width = std::max(width, row.name.size());
    }
    std::string text = "Energy absorption coefficients per octave (Hz):\n\n";
    text += std::string(width, ' ') + columns_header() + "\n";
    for (const LibraryMaterial& row : rows) {
        text += padded(std::string(row.name), width) + columns(row.material.absorption) + "  " +
                std::string(row.description) + "\n";
    }
    text += "\n" + std::to_string(rows.size()) +
            " materials; earshot materials NAME gives the source of one.\n";
    return text;
}

std::string description(const LibraryMaterial& row) {
    const std::string name(row.name);
    std::string text = name + ": " + std::string(row.description) + "\n";
    text += "Source: " + std::string(row.source) + "\n\n";
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
                             {"absorption", to_json(row.material.absorption)},
                             {"scattering", to_json(row.material.scattering)},
                             {"transmission", to_json(row.material.transmission)}});
    }
    return Json{{"version", 1}, {"materials", materials}}.dump(1) + "\n";
}

class MaterialsCommand : public Command {
public:
    explicit MaterialsCommand(CLI::App& program)
        : Command(program, "materials", "List the built-in library of acoustic materials") {
        app()
            .add_option("NAME", name_, "show only this material, with its literature source")
            ->type_name("");
        app().footer(
            "Examples:\n"
            "  earshot materials                  the whole table\n"
            "  earshot materials brick-painted    one material and where its numbers come from\n"
            "  earshot materials --json           for a program\n\n"
            "A glTF material refers to one by its own name, or by\n"
            "  \"extras\": {\"acoustics\": {\"library\": \"brick-painted\"}}");
    }

    void run() override {
        const std::span<const LibraryMaterial> rows = chosen_rows();
        if (common().json) {
            write_output(json_text(rows));
        } else {
            write_output(name_.empty() ? table(rows) : description(rows.front()));
        }
    }

private:
    // All rows, or the named one.
    std::span<const LibraryMaterial> chosen_rows() {
        const std::span<const LibraryMaterial> rows = propagation::material_library();
        if (name_.empty()) {
            return rows;
        }
        std::vector<std::string> names;
        for (const LibraryMaterial& row : rows) {
            names.emplace_back(row.name);
        }
        const auto found = std::find(names.begin(), names.end(), name_);
        if (found == names.end()) {
            throw UsageError(name_,
                             "no such material in the library",
                             did_you_mean(name_, names, "see earshot materials"));
        }
        return rows.subspan(static_cast<std::size_t>(found - names.begin()), 1);
    }

    std::string name_;
};

}  // namespace

std::unique_ptr<Command> make_materials_command(CLI::App& program) {
    return std::make_unique<MaterialsCommand>(program);
}

}  // namespace earshot::cli
