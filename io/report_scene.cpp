// SPDX-License-Identifier: MIT
#include "earshot/base/sha256.h"
#include "earshot/geometry/mesh.h"
#include "earshot/io/internal/base64.h"
#include "earshot/io/internal/bytes.h"
#include "earshot/io/internal/json_lines.h"
#include "earshot/io/internal/report_blocks.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using geometry::Vec3;

std::vector<double> areas_of(const geometry::AnimatedMesh& mesh, std::span<const Vec3> positions) {
    std::vector<double> areas;
    areas.reserve(mesh.triangles().size());
    for (const geometry::Triangle& triangle : mesh.triangles()) {
        const auto [a, b, c] = geometry::corners(positions, triangle);
        areas.push_back(0.5 * glm::length(glm::cross(b - a, c - a)));
    }
    return areas;
}

/// Indices of the triangles that are shown, ascending.
std::vector<std::size_t> shown_triangles(std::span<const double> areas) {
    std::vector<std::size_t> shown(areas.size());
    std::iota(shown.begin(), shown.end(), std::size_t{0});
    if (shown.size() > kMaxReportTriangles) {
        const auto end = shown.begin() + static_cast<long>(kMaxReportTriangles);
        std::nth_element(shown.begin(), end, shown.end(), [&](std::size_t a, std::size_t b) {
            return areas[a] != areas[b] ? areas[a] > areas[b] : a < b;
        });
        shown.erase(end, shown.end());
        std::sort(shown.begin(), shown.end());
    }
    return shown;
}

/// Runs of shown triangles of one mesh.
Json meshes_of(const geometry::AnimatedMesh& mesh, std::span<const std::size_t> shown) {
    constexpr std::size_t kMaxRuns = 5000;
    Json meshes = Json::array();
    for (std::size_t first = 0; first < shown.size() && meshes.size() < kMaxRuns;) {
        const std::uint32_t of = mesh.mesh_of_triangle()[shown[first]];
        std::size_t end = first;
        while (end < shown.size() && mesh.mesh_of_triangle()[shown[end]] == of) {
            ++end;
        }
        meshes.push_back({{"name", mesh.mesh_names()[of]},
                          {"first_triangle", first},
                          {"triangle_count", end - first}});
        first = end;
    }
    return meshes;
}

}  // namespace

std::string scene_digest(const propagation::Scene& scene, double time) {
    ByteWriter bytes;
    const auto add_point = [&](const Vec3& point) {
        bytes.number(point.x);
        bytes.number(point.y);
        bytes.number(point.z);
    };
    for (const Vec3& position : scene.mesh.positions_at(time)) {
        add_point(position);
    }
    for (const geometry::Triangle& triangle : scene.mesh.triangles()) {
        for (const geometry::VertexId vertex : triangle) {
            bytes.fixed(vertex, 4);
        }
    }
    for (const std::uint32_t material : scene.material_of_triangle) {
        bytes.fixed(material, 4);
    }
    for (const propagation::Material& material : scene.materials) {
        bytes.string(material.name);
        bytes.fixed(material.one_sided ? 1 : 0, 1);
        for (const auto* coefficient :
             {&material.absorption, &material.scattering, &material.transmission}) {
            bytes.leb128(coefficient->points().size());
            for (const auto& point : coefficient->points()) {
                bytes.number(point.frequency_hz);
                bytes.number(point.value);
            }
        }
    }
    for (const auto* emitters : {&scene.sources, &scene.listeners}) {
        bytes.leb128(emitters->size());
        for (const propagation::Emitter& emitter : *emitters) {
            bytes.string(emitter.name);
            add_point(scene.position_at(emitter, time));
        }
    }
    return hex_text(sha256(bytes.bytes()));
}

Json scene_block(const propagation::Scene& scene, double time, Warnings& warnings) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(time);
    const std::vector<std::size_t> shown = shown_triangles(areas_of(scene.mesh, positions));
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(positions.size(), kUnused);
    std::vector<float> coordinates;
    std::vector<std::uint32_t> corners;
    std::vector<std::uint16_t> materials;
    for (const std::size_t triangle : shown) {
        for (const geometry::VertexId vertex : scene.mesh.triangles()[triangle]) {
            if (number[vertex] == kUnused) {
                number[vertex] = static_cast<std::uint32_t>(coordinates.size() / 3);
                for (int axis = 0; axis < 3; ++axis) {
                    coordinates.push_back(static_cast<float>(positions[vertex][axis]));
                }
            }
            corners.push_back(number[vertex]);
        }
        constexpr std::uint32_t kMaxMaterial = std::numeric_limits<std::uint16_t>::max();
        materials.push_back(static_cast<std::uint16_t>(
            std::min(scene.material_of_triangle[triangle], kMaxMaterial)));
    }
    const std::size_t left_out = scene.mesh.triangles().size() - shown.size();
    if (left_out > 0) {
        warnings.push_back({scene.name,
                            "the page shows the " + std::to_string(shown.size()) + " largest of " +
                                std::to_string(shown.size() + left_out) + " triangles"});
    }
    return {{"positions_f32", base64(coordinates)},
            {"triangles_u32", base64(corners)},
            {"material_u16", base64(materials)},
            {"left_out", left_out},
            {"meshes", meshes_of(scene.mesh, shown)}};
}

Json materials_block(const propagation::Scene& scene,
                     double time,
                     std::span<const std::uint32_t> default_materials,
                     const audio::Bands& bands) {
    const std::vector<Vec3> positions = scene.mesh.positions_at(time);
    const std::vector<double> areas = areas_of(scene.mesh, positions);
    std::vector<double> area_of_material(scene.materials.size(), 0.0);
    for (std::size_t triangle = 0; triangle < areas.size(); ++triangle) {
        area_of_material[scene.material_of_triangle[triangle]] += areas[triangle];
    }
    const auto list = [&](const propagation::EnergyCoefficient& coefficient) {
        const audio::Spectrum values = coefficient.over(bands);
        return Json(
            std::vector<double>(values.begin(), values.begin() + static_cast<long>(bands.count())));
    };
    Json materials = Json::array();
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const bool guessed = std::find(default_materials.begin(), default_materials.end(), i) !=
                             default_materials.end();
        materials.push_back({{"name", scene.materials[i].name},
                             {"area", area_of_material[i]},
                             {"absorption", list(scene.materials[i].absorption)},
                             {"scattering", list(scene.materials[i].scattering)},
                             {"guessed", guessed}});
    }
    return materials;
}

}  // namespace earshot::io
