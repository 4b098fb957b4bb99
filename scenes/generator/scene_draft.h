// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/gtc/quaternion.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace earshot::scenes {

using geometry::Vec3;

/// Energy coefficients of the octaves from 125 Hz to 8 kHz.
using Octaves = std::array<double, 7>;

/// What a surface is made of, and how it looks in a viewer.
struct SurfaceMaterial {
    std::string name;
    std::string library;      ///< row of the material library; empty: what follows counts
    double absorption = 0.0;  ///< energy coefficient in all bands
    double scattering = 0.0;  ///< likewise
    /// In place of the row's coefficients, where given.
    std::optional<Octaves> row_absorption{}, row_scattering{};
    std::array<double, 3> colour = {0.8, 0.8, 0.8};  ///< linear red, green, blue in 0..1
    bool in_picture = true;  ///< false: left out of drawings, where it would only be in the way
};

/// A flat triangle or quadrilateral; counter-clockwise seen from the air in front of it.
struct Face {
    std::array<Vec3, 4> corners{};
    std::size_t corner_count = 4;  ///< 3 or 4
    std::size_t material = 0;      ///< index into SceneDraft::materials
};

using Faces = std::vector<Face>;

/// Key frames of a node's rotation, interpolated along great arcs.
struct RotationKeys {
    std::vector<double> times;  ///< seconds, ascending
    std::vector<glm::dquat> rotations;
};

/// Key frames of the weights of a node's morph targets.
struct WeightKeys {
    std::vector<double> times;                 ///< seconds, ascending
    std::vector<std::vector<double>> weights;  ///< one per target at each time
};

enum class Role { none, source, listener };

/// A node of the scene: geometry, a source or a listener.
struct DraftNode {
    std::string name;
    Vec3 translation{0.0};
    Faces faces;
    Role role = Role::none;
    RotationKeys rotation;  ///< no keys: does not turn
    /// Morph targets: displacement of the point that rests at the given position.
    std::vector<std::function<Vec3(const Vec3&)>> morphs;
    WeightKeys weights;
};

/// A scene being authored.
struct SceneDraft {
    std::string name;
    std::vector<SurfaceMaterial> materials;
    std::vector<DraftNode> nodes;

    /// Index of a material of the library under its own name, added where it is new. Throws Error
    /// if the library has no such row.
    std::size_t library_material(const std::string& row, std::array<double, 3> colour);

    /// Gives a material the coefficients of another row; its name stays. `coverage` is the number
    /// of square metres of the row on each of the modelled surface, as audience is measured per
    /// area of floor: the factor of the absorption.
    void spread_row(std::size_t material, const std::string& row, double coverage);

    /// Gives a material the scattering of a row.
    void take_scattering(std::size_t material, const std::string& row);

    /// Gives a material the scattering of a structure `depth` metres deep: 0.5 sqrt(depth /
    /// wavelength), 0.1 ... 0.99 (Postma and Katz 2015), to two digits.
    void set_structure(std::size_t material, double depth);

    /// Index of a new material that absorbs the same in all bands and scatters nothing, as the
    /// closed-form solutions demand.
    std::size_t plain_material(std::string material_name, double absorption);

    void add_geometry(std::string node_name, Faces faces);
    void add_source(std::string node_name, const Vec3& position);
    void add_listener(std::string node_name, const Vec3& position);
};

}  // namespace earshot::scenes
