// SPDX-License-Identifier: MIT
#include "earshot/scenes/scene_draft.h"

#include "earshot/base/error.h"
#include "earshot/propagation/material.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::scenes {

namespace {

double octave_hz(std::size_t octave) {
    return 125.0 * static_cast<double>(1U << octave);
}

propagation::Material library_row(const std::string& row) {
    auto found = propagation::find_library_material(row);
    if (!found) {
        throw Error(row, "is no row of the material library", "see earshot materials");
    }
    return std::move(*found);
}

double two_digits(double value) {
    return std::round(100.0 * value) / 100.0;
}

}  // namespace

std::size_t SceneDraft::library_material(const std::string& row, std::array<double, 3> colour) {
    for (std::size_t index = 0; index < materials.size(); ++index) {
        if (materials[index].name == row) {
            return index;
        }
    }
    library_row(row);
    SurfaceMaterial material;
    material.name = row;
    material.library = row;
    material.colour = colour;
    materials.push_back(std::move(material));
    return materials.size() - 1;
}

void SceneDraft::spread_row(std::size_t material, const std::string& row, double coverage) {
    const propagation::Material data = library_row(row);
    materials[material].library = row;
    if (coverage != 1.0) {
        Octaves& absorption = materials[material].row_absorption.emplace();
        for (std::size_t octave = 0; octave < absorption.size(); ++octave) {
            absorption[octave] = two_digits(coverage * data.absorption.at(octave_hz(octave)));
        }
    }
}

void SceneDraft::take_scattering(std::size_t material, const std::string& row) {
    const propagation::Material data = library_row(row);
    Octaves& scattering = materials[material].row_scattering.emplace();
    for (std::size_t octave = 0; octave < scattering.size(); ++octave) {
        scattering[octave] = data.scattering.at(octave_hz(octave));
    }
}

void SceneDraft::set_structure(std::size_t material, double depth) {
    constexpr double kSpeedOfSound = 343.2;
    Octaves& scattering = materials[material].row_scattering.emplace();
    for (std::size_t octave = 0; octave < scattering.size(); ++octave) {
        const double wavelength = kSpeedOfSound / octave_hz(octave);
        scattering[octave] = two_digits(std::clamp(0.5 * std::sqrt(depth / wavelength), 0.1, 0.99));
    }
}

std::size_t SceneDraft::plain_material(std::string material_name, double absorption) {
    SurfaceMaterial material;
    material.name = std::move(material_name);
    material.absorption = absorption;
    materials.push_back(std::move(material));
    return materials.size() - 1;
}

void SceneDraft::add_geometry(std::string node_name, Faces faces) {
    DraftNode node;
    node.name = std::move(node_name);
    node.faces = std::move(faces);
    nodes.push_back(std::move(node));
}

void SceneDraft::add_source(std::string node_name, const Vec3& position) {
    DraftNode node;
    node.name = std::move(node_name);
    node.translation = position;
    node.role = Role::source;
    nodes.push_back(std::move(node));
}

void SceneDraft::add_listener(std::string node_name, const Vec3& position) {
    add_source(std::move(node_name), position);
    nodes.back().role = Role::listener;
}

}  // namespace earshot::scenes
