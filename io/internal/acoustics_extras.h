// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/propagation/material.h"

#include <nlohmann/json.hpp>

#include <string>

namespace earshot::io {

/// The library's material of that name, or the default with a warning that names it. `name` stays
/// the material's name.
propagation::Material material_named(const std::string& name,
                                     const std::string& file,
                                     Warnings& warnings);

/// A glTF material: its extras.acoustics, or else as material_named. Throws Error naming file and
/// material for coefficients out of 0..1, what is not a number, and unknown library names.
propagation::Material read_material(const nlohmann::json& material,
                                    const std::string& name,
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
