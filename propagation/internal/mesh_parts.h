// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Triangles that are connected at their vertices, as a mesh of its own.
struct MeshPart {
    geometry::Mesh mesh;                ///< equal vertices are one
    std::vector<std::uint32_t> labels;  ///< per triangle
    bool is_closed = false;             ///< every edge has an even number of triangles
    double volume = 0.0;  ///< enclosed, cubic metres; negative where fronts face inside
};

/// Whether every edge has an even number of triangles. Precondition: equal vertices are one.
bool is_closed_surface(const geometry::Mesh& mesh);

/// What a closed surface encloses, cubic metres; negative where its fronts face inside.
double enclosed_volume(const geometry::Mesh& mesh);

/// The triangles of one label, with the positions of all.
geometry::Mesh with_label(const geometry::Mesh& mesh,
                          std::span<const std::uint32_t> labels,
                          std::uint32_t label);

double surface_area(const geometry::Mesh& mesh);

struct MeshParts {
    std::vector<MeshPart> parts;  ///< by their first triangles
    std::size_t vertices = 0;     ///< of all
    std::size_t dropped = 0;      ///< triangles that clean-up drops
};

/// The parts of what clean-up keeps of a mesh.
MeshParts find_mesh_parts(const geometry::MeshView& mesh,
                          std::span<const std::uint32_t> labels,
                          Executor& executor);

}  // namespace earshot::propagation
