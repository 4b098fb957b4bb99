// SPDX-License-Identifier: MIT
// Scenes that programs make: from arrays, and rooms from their measures.
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/propagation/room_shapes.h"

#include <glm/vec2.hpp>

#include <algorithm>
#include <memory>
#include <string>

namespace earshot::capi {
namespace {

/// A name per item, those of the caller or "PREFIX 0", "PREFIX 1", ...
std::vector<std::string> names_of(const char* const* names,
                                  std::size_t count,
                                  const std::string& prefix,
                                  const char* argument) {
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < count; ++i) {
        texts.push_back(names == nullptr ? prefix + " " + std::to_string(i)
                                         : std::string(require_text(names[i], argument)));
    }
    return texts;
}

/// A number below `count` per triangle; all 0 where none are given.
std::vector<std::uint32_t> numbers_of(const std::uint32_t* numbers,
                                      std::size_t triangles,
                                      std::size_t count,
                                      const char* argument) {
    if (numbers == nullptr) {
        return std::vector<std::uint32_t>(triangles);
    }
    // The copy is checked: another thread of the caller may write to what was given.
    std::vector<std::uint32_t> copy(numbers, numbers + triangles);
    for (const std::uint32_t number : copy) {
        require_index(number, count, argument);
    }
    return copy;
}

/// Materials of the library have their data, the others the default.
void add_materials(const std::vector<std::string>& names, io::LoadedScene& loaded) {
    for (const std::string& name : names) {
        auto known = propagation::find_library_material(name);
        if (known) {
            loaded.materials_by_name.push_back(
                static_cast<std::uint32_t>(loaded.scene.materials.size()));
        } else {
            loaded.default_materials.push_back(
                static_cast<std::uint32_t>(loaded.scene.materials.size()));
            known.emplace();
            known->absorption = propagation::EnergyCoefficient(0.1);
            known->scattering = propagation::EnergyCoefficient(0.1);
        }
        known->name = name;
        loaded.scene.materials.push_back(std::move(*known));
    }
}

std::shared_ptr<SceneObject> scene_of(const es_scene_arrays& arrays) {
    constexpr std::size_t kMaxNames = 1U << 24U;
    auto object = std::make_shared<SceneObject>();
    propagation::Scene& scene = object->loaded.scene;
    scene.name = text_or(arrays.name, "scene", "arrays->name");
    const auto vertices = require_points(arrays.vertices, arrays.vertex_count, "arrays->vertices");
    auto triangles = require_triangles(
        arrays.triangles, arrays.triangle_count, arrays.vertex_count, "arrays->triangles");
    require_count(arrays.material_count, 0, kMaxNames, "arrays->material_count");
    require_count(arrays.mesh_count, 0, kMaxNames, "arrays->mesh_count");
    const std::size_t material_count = std::max<std::size_t>(arrays.material_count, 1);
    const std::size_t mesh_count = std::max<std::size_t>(arrays.mesh_count, 1);
    scene.material_of_triangle = numbers_of(arrays.material_of_triangle,
                                            triangles.size(),
                                            material_count,
                                            "arrays->material_of_triangle");
    auto mesh_of_triangle = numbers_of(
        arrays.mesh_of_triangle, triangles.size(), mesh_count, "arrays->mesh_of_triangle");
    add_materials(names_of(arrays.material_count == 0 ? nullptr : arrays.material_names,
                           material_count,
                           "material",
                           "arrays->material_names"),
                  object->loaded);
    scene.mesh = geometry::AnimatedMesh::fixed(
        {.positions = {vertices.begin(), vertices.end()}, .triangles = std::move(triangles)});
    scene.mesh.set_meshes(names_of(arrays.mesh_count == 0 ? nullptr : arrays.mesh_names,
                                   mesh_count,
                                   "mesh",
                                   "arrays->mesh_names"),
                          std::move(mesh_of_triangle));
    return object;
}

es_scene publish_room(propagation::Scene room) {
    auto object = std::make_shared<SceneObject>();
    object->loaded.scene = std::move(room);
    for (std::uint32_t i = 0; i < object->loaded.scene.materials.size(); ++i) {
        object->loaded.default_materials.push_back(i);
    }
    return publish(std::move(object));
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_scene_arrays_init(es_scene_arrays* arrays, size_t size) {
    return call(__func__,
                [&] { init_struct(es_scene_arrays{}, arrays, size, sizeof(es_scene_arrays)); });
}

es_status es_scene_create(const es_scene_arrays* arrays, es_scene* scene) {
    return call(__func__, [&] {
        const es_scene_arrays given = require_struct(
            require(arrays, "arrays"), es_scene_arrays{}, sizeof(es_scene_arrays), "arrays");
        require(scene, "scene");
        *scene = publish(scene_of(given));
    });
}

es_status es_scene_create_shoebox(const double size[3], es_scene* scene) {
    return call(__func__, [&] {
        require(size, "size");
        require(scene, "scene");
        *scene = publish_room(propagation::shoebox_room({size[0], size[1], size[2]}));
    });
}

es_status es_scene_create_extruded(const double* corners,
                                   size_t corner_count,
                                   double height,
                                   es_scene* scene) {
    return call(__func__, [&] {
        const auto plan =
            require_array(reinterpret_cast<const glm::dvec2*>(corners), corner_count, "corners");
        require(scene, "scene");
        *scene = publish_room(propagation::extruded_room(plan, height));
    });
}
