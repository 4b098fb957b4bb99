// SPDX-License-Identifier: MIT
#include "earshot/geometry/predicates.h"
#include "earshot/io/internal/acoustics_extras.h"
#include "earshot/io/internal/polygons.h"
#include "earshot/io/internal/scene_parts.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::io {
namespace {

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

/// Also takes coordinates that are too small for exact predicates for 0.
void check_positions(geometry::Mesh& mesh, const std::string& file) {
    constexpr std::size_t kMaxCount = std::numeric_limits<std::uint32_t>::max();
    if (mesh.positions.size() > kMaxCount || mesh.triangles.size() > kMaxCount) {
        throw Error(file, "has more than 2^32 vertices or triangles", "split it");
    }
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        geometry::Vec3& p = mesh.positions[i];
        const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        const bool is_number = !std::isnan(p.x) && !std::isnan(p.y) && !std::isnan(p.z);
        if (!is_number || largest > kMaxCoordinate) {
            throw Error(file,
                        "vertex " + std::to_string(i) +
                            (is_number ? " lies beyond 1e12 m" : " is not a number"),
                        "check the units of the export");
        }
        p = geometry::without_tiny_coordinates(p);
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
    check_positions(read.mesh, file);
    LoadedScene loaded;
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
