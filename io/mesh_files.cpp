// SPDX-License-Identifier: MIT
#include "earshot/io/internal/acoustics_extras.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/scene_parts.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::io {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

PolygonMesh parse(std::string_view bytes, MeshFormat format, const std::string& file) {
    switch (format) {
        case MeshFormat::obj:
            return parse_obj(bytes, file);
        case MeshFormat::ply:
            return parse_ply(bytes, file);
        case MeshFormat::stl:
            return parse_stl(bytes, file);
        case MeshFormat::off:
            break;
    }
    return parse_off(bytes, file);
}

void check_counts(const geometry::Mesh& mesh, const std::string& file) {
    constexpr std::size_t kMaxCount = std::numeric_limits<std::uint32_t>::max();
    if (mesh.positions.size() > kMaxCount || mesh.triangles.size() > kMaxCount) {
        throw Error(file, "has more than 2^32 vertices or triangles", "split it");
    }
}

/// Keeps the vertices that a triangle uses, in their order. Organised scans mark the points they
/// lack by NaN, and no face uses those.
void drop_unused_vertices(geometry::Mesh& mesh, const std::vector<bool>& is_used) {
    if (std::find(is_used.begin(), is_used.end(), false) == is_used.end()) {
        return;
    }
    std::vector<VertexId> renumbered(is_used.size());
    VertexId next = 0;
    for (std::size_t i = 0; i < is_used.size(); ++i) {
        renumbered[i] = next;
        mesh.positions[next] = mesh.positions[i];
        next += is_used[i] ? 1 : 0;
    }
    mesh.positions.resize(next);
    for (Triangle& triangle : mesh.triangles) {
        for (VertexId& vertex : triangle) {
            vertex = renumbered[vertex];
        }
    }
}

void clean_vertices(geometry::Mesh& mesh, const std::string& file) {
    std::vector<bool> is_used(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles) {
        for (const VertexId vertex : triangle) {
            is_used[vertex] = true;
        }
    }
    for (std::size_t i = 0; i < is_used.size(); ++i) {
        if (is_used[i]) {
            clean_position(mesh.positions[i], i, file);
        }
    }
    drop_unused_vertices(mesh, is_used);
}

/// The unit in a comment is a hint: it is told where no unit was given.
void warn_of_stated_unit(const PolygonMesh& read,
                         const FileFrame& frame,
                         const std::string& file,
                         Warnings& warnings) {
    if (read.stated_unit && read.stated_unit->unit != "m" && frame.metres_per_unit == 1.0) {
        warnings.push_back({file,
                            "it states \"" + read.stated_unit->words +
                                "\", but its coordinates are taken as metres; --units " +
                                read.stated_unit->unit + " takes them so"});
    }
}

}  // namespace

LoadedScene load_mesh_file(const std::filesystem::path& path,
                           MeshFormat format,
                           const FileFrame& frame) {
    const std::string file = path.string();
    PolygonMesh read = parse(read_whole_file(path), format, file);
    if (!frame.is_default()) {
        for (geometry::Vec3& position : read.mesh.positions) {
            position = frame.to_scene(position);
        }
    }
    check_counts(read.mesh, file);
    clean_vertices(read.mesh, file);
    LoadedScene loaded;
    loaded.warnings = std::move(read.warnings);
    warn_of_stated_unit(read, frame, file, loaded.warnings);
    if (read.material_names.empty()) {
        read.material_names.emplace_back("default");
        read.material_of_triangle.assign(read.mesh.triangles.size(), 0);
    }
    for (const std::string& name : read.material_names) {
        ReadMaterial material = material_named(name);
        if (material.is_default) {
            loaded.default_materials.push_back(
                static_cast<std::uint32_t>(loaded.scene.materials.size()));
        }
        if (material.is_by_name) {
            loaded.materials_by_name.push_back(
                static_cast<std::uint32_t>(loaded.scene.materials.size()));
        }
        loaded.scene.materials.push_back(std::move(material.material));
    }
    loaded.scene.material_of_triangle = std::move(read.material_of_triangle);
    loaded.scene.mesh = geometry::AnimatedMesh::fixed(std::move(read.mesh));
    if (read.mesh_names.empty()) {
        read.mesh_names.emplace_back();
        read.mesh_of_triangle.assign(loaded.scene.mesh.triangles().size(), 0);
    }
    for (std::string& name : read.mesh_names) {
        name = name.empty() ? path.stem().string() : name;
    }
    loaded.scene.mesh.set_meshes(std::move(read.mesh_names), std::move(read.mesh_of_triangle));
    return loaded;
}

}  // namespace earshot::io
