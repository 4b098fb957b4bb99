// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/propagation/material.h"

#include <nlohmann/json.hpp>

#include <string>

namespace earshot::io {

/// What a scene file's material is where the file does not say: absorption 0.1 and scattering 0.1
/// in every band. Real walls are not mirrors; those of propagation::Material{} are.
propagation::Material default_material();

/// A material, and whether its acoustic data is the default for want of any.
struct ReadMaterial {
    propagation::Material material;
    bool is_default = false;
    bool is_by_name = false;  ///< of the library's material of that name, for want of data
};

/// The library's material of that name, or the default. `name` stays the material's name.
ReadMaterial material_named(const std::string& name);

/// A glTF material: its extras.acoustics (an object, a library name, or the object as JSON text)
/// and flat keys acoustics_library, acoustics_absorption, ..., or else as material_named. Keys that
/// are nearly ours are warned of. Throws Error naming file and material for coefficients out of
/// 0..1, what is not a number, and unknown library names.
ReadMaterial read_material(const nlohmann::json& material,
                           const std::string& name,
                           const std::string& file,
                           Warnings& warnings);

/// The value of extras.acoustics alone: a library name or an object. `element` names it in errors.
/// Throws as read_material; the material has the library's name or none.
propagation::Material read_acoustics(const nlohmann::json& value,
                                     const std::string& element,
                                     const std::string& file,
                                     Warnings& warnings);

enum class Role { none, source, listener };

/// A node's extras.acoustics.
struct NodeAcoustics {
    Role role = Role::none;
    std::string directivity;
};

/// Throws Error naming file and node for an unknown role.
NodeAcoustics read_node_acoustics(const nlohmann::json& node,
                                  const std::string& name,
                                  const std::string& file,
                                  Warnings& warnings);

/// "nearest are a, b, c (see earshot materials)": the library's names of smallest edit distance, as
/// the remedy of an error.
std::string nearest_library_names(const std::string& name);

}  // namespace earshot::io
