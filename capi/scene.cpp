// SPDX-License-Identifier: MIT
// Scenes: from files and from a copy, what they consist of, where it is.
#include "earshot/base/spelling.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/io/material_assignments.h"
#include "earshot/propagation/simulator.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace earshot::capi {
namespace {

using propagation::Scene;

constexpr es_load_options kLoadDefaults = {
    sizeof(es_load_options), nullptr, nullptr, ES_UP_Y, 0, 1, 0};

io::SceneOptions scene_options(const es_load_options& options) {
    io::SceneOptions scene = {
        .animation = std::string(text_or(options.animation, "", "options->animation")),
        .allow_outside = options.allow_outside != 0};
    const std::string units(text_or(options.units, "m", "options->units"));
    const auto metres = io::metres_per_unit(units);
    if (!metres) {
        fail_argument("options->units", "is \"" + units + "\"", "give m, cm, mm, in or ft");
    }
    require_in(std::int64_t{options.up}, ES_UP_Y, ES_UP_Z, "options->up");
    require_flag(options.allow_outside, "options->allow_outside");
    require_flag(options.read_materials, "options->read_materials");
    scene.frame = {.metres_per_unit = *metres,
                   .up = options.up == ES_UP_Z ? io::UpAxis::z : io::UpAxis::y};
    return scene;
}

/// The names of the items of a kind that have names.
std::size_t name_count(const Scene& scene, std::int32_t item) {
    switch (item) {
        case ES_SOURCES:
            return scene.sources.size();
        case ES_LISTENERS:
            return scene.listeners.size();
        case ES_MATERIALS:
            return scene.materials.size();
        case ES_MESHES:
            return scene.mesh.mesh_names().size();
        default:
            fail_argument("item",
                          "is " + std::to_string(item),
                          "give ES_SOURCES, ES_LISTENERS, ES_MATERIALS or ES_MESHES");
    }
}

const std::string& name_of(const Scene& scene, std::int32_t item, std::size_t index) {
    return item == ES_SOURCES     ? scene.sources[index].name
           : item == ES_LISTENERS ? scene.listeners[index].name
           : item == ES_MATERIALS ? scene.materials[index].name
                                  : scene.mesh.mesh_names()[index];
}

std::size_t count_of(const Scene& scene, std::int32_t item) {
    switch (item) {
        case ES_TRIANGLES:
            return scene.mesh.triangles().size();
        case ES_VERTICES:
            return scene.mesh.vertex_count();
        default:
            return name_count(scene, item);
    }
}

std::uint32_t find(const Scene& scene, std::int32_t item, std::string_view name) {
    const std::size_t count = name_count(scene, item);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) {
        names.push_back(name_of(scene, item, i));
    }
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        constexpr const char* kItems[] = {"source", "listener", "material", "mesh"};
        throw Error(std::string(name),
                    std::string("the scene has no such ") + kItems[item],
                    did_you_mean(name, names, "check the names that the scene has"));
    }
    return static_cast<std::uint32_t>(found - names.begin());
}

/// The same scene with its vertices elsewhere. Nodes stay for the emitters that ride on them.
void move_vertices(std::span<const geometry::Vec3> positions, Scene& scene) {
    const geometry::AnimatedMesh& old = scene.mesh;
    std::vector<geometry::Part> parts(1);
    parts[0].positions.assign(positions.begin(), positions.end());
    geometry::AnimatedMesh moved(old.nodes(), {}, std::move(parts), old.triangles());
    moved.set_meshes(old.mesh_names(), old.mesh_of_triangle());
    scene.mesh = std::move(moved);
}

Warnings check(const SceneObject& object, double time) {
    const Scene& scene = object.loaded.scene;
    Warnings list = object.loaded.warnings;
    const auto append = [&](const Warnings& more) {
        list.insert(list.end(), more.begin(), more.end());
    };
    append(io::warnings_of_acoustics(object.loaded));
    if (scene.mesh.triangles().empty()) {
        append({{scene.name, "has no triangles"}});
        return list;
    }
    const geometry::Vec3 size = propagation::scene_extent(scene, time).size();
    if (const auto proposal = propagation::propose_unit(
            size, 0.0, object.read_as, propagation::model_kind(scene, time))) {
        append({{scene.name, propagation::unit_warning(*proposal, size, object.has_unit_option)}});
    }
    append(propagation::misplaced_emitters(scene, time));
    try {
        propagation::Simulator simulator(scene);
        simulator.set_time(time);
        append(simulator.warnings());
    } catch (const Error& error) {  // What no simulation takes is told as well.
        append({{error.subject(),
                 error.what() + (error.remedy().empty() ? "" : "; " + error.remedy())}});
    }
    return list;
}

}  // namespace

void require_triangles_of(const Scene& scene) {
    if (scene.mesh.triangles().empty()) {
        throw Error(scene.name, "has no triangles", "give it geometry");
    }
}

void require_time(double time, const char* argument) {
    require_in(time, -1e12, 1e12, argument);
}

es_messages publish_messages(Warnings list) {
    return publish(std::make_shared<MessagesObject>(std::move(list)));
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_load_options_init(es_load_options* options, size_t size) {
    return call(__func__,
                [&] { init_struct(kLoadDefaults, options, size, sizeof(es_load_options)); });
}

es_status es_scene_load(const char* file, const es_load_options* options, es_scene* scene) {
    return call(__func__, [&] {
        const std::filesystem::path path(require_text(file, "file"));
        require(scene, "scene");
        const es_load_options given =
            options == nullptr
                ? kLoadDefaults
                : require_struct(*options, kLoadDefaults, sizeof(es_load_options), "options");
        const io::SceneOptions how = scene_options(given);
        auto object = std::make_shared<SceneObject>();
        object->loaded = io::load_scene(path, how);
        object->read_as = {.metres_per_unit = how.frame.metres_per_unit,
                           .z_is_up = how.frame.up == io::UpAxis::z};
        object->has_unit_option = !io::is_gltf(path);
        const std::filesystem::path materials = io::material_assignments_file(path);
        if (given.read_materials != 0 && std::filesystem::exists(materials)) {
            io::assign_materials(
                io::read_material_assignments(materials, object->loaded.acoustic_warnings),
                object->loaded);
        }
        *scene = publish(std::move(object));
    });
}

es_status es_scene_copy(es_scene scene, es_scene* copy) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(copy, "copy");
        auto other = std::make_shared<SceneObject>();
        other->loaded = object->loaded;
        other->read_as = object->read_as;
        other->has_unit_option = object->has_unit_option;
        *copy = publish(std::move(other));
    });
}

es_status es_scene_count(es_scene scene, int32_t item, size_t* count) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(count, "count") = count_of(object->loaded.scene, item);
    });
}

es_status es_scene_item_name(es_scene scene, int32_t item, size_t index, const char** name) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(name, "name");
        require_index(index, name_count(object->loaded.scene, item), "index");
        *name = name_of(object->loaded.scene, item, index).c_str();
    });
}

es_status es_scene_find(es_scene scene, int32_t item, const char* name, uint32_t* index) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(index, "index");
        *index = find(object->loaded.scene, item, require_text(name, "name"));
    });
}

es_status es_scene_name(es_scene scene, const char** name) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(name, "name") = object->loaded.scene.name.c_str();
    });
}

es_status es_scene_duration(es_scene scene, double* duration) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(duration, "duration") = object->loaded.scene.mesh.duration();
    });
}

es_status es_scene_extent(es_scene scene, double time, double lower[3], double upper[3]) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(lower, "lower");
        require(upper, "upper");
        require_time(time, "time");
        require_triangles_of(object->loaded.scene);
        const auto extent = propagation::scene_extent(object->loaded.scene, time);
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = extent.lower[axis];
            upper[axis] = extent.upper[axis];
        }
    });
}

es_status es_scene_positions(es_scene scene, double time, double* positions, size_t vertex_count) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        const geometry::AnimatedMesh& mesh = object->loaded.scene.mesh;
        require_size(vertex_count, mesh.vertex_count(), "vertex_count");
        require_time(time, "time");
        mesh.positions_at(
            time,
            require_array(reinterpret_cast<geometry::Vec3*>(positions), vertex_count, "positions"));
    });
}

es_status es_scene_triangles(es_scene scene,
                             const uint32_t** triangles,
                             const uint32_t** materials,
                             const uint32_t** meshes,
                             size_t* count) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        const propagation::Scene& contents = object->loaded.scene;
        require(count, "count") = contents.mesh.triangles().size();
        if (triangles != nullptr) {
            *triangles = reinterpret_cast<const uint32_t*>(contents.mesh.triangles().data());
        }
        if (materials != nullptr) {
            *materials = contents.material_of_triangle.data();
        }
        if (meshes != nullptr) {
            *meshes = contents.mesh.mesh_of_triangle().data();
        }
    });
}

es_status es_scene_set_positions(es_scene scene, const double* positions, size_t vertex_count) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        propagation::Scene& contents = object->loaded.scene;
        if (contents.mesh.duration() > 0.0) {
            throw Error(contents.name,
                        "has an animation, which moves its vertices",
                        "give a scene without one");
        }
        require_size(vertex_count, contents.mesh.vertex_count(), "vertex_count");
        move_vertices(require_points(positions, vertex_count, "positions"), contents);
    });
}

es_status es_scene_warnings(es_scene scene, es_messages* messages) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(messages, "messages");
        Warnings list = object->loaded.warnings;
        const Warnings& acoustic = object->loaded.acoustic_warnings;
        list.insert(list.end(), acoustic.begin(), acoustic.end());
        *messages = publish_messages(std::move(list));
    });
}

es_status es_scene_check(es_scene scene, double time, es_messages* messages) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        require(messages, "messages");
        require_time(time, "time");
        *messages = publish_messages(check(*object, time));
    });
}

es_status es_messages_count(es_messages messages, size_t* count) {
    return call(__func__, [&] {
        const Reading<MessagesObject> object(messages, "messages");
        require(count, "count") = object->list.size();
    });
}

es_status es_messages_get(es_messages messages,
                          size_t index,
                          const char** subject,
                          const char** text) {
    return call(__func__, [&] {
        const Reading<MessagesObject> object(messages, "messages");
        require(subject, "subject");
        require(text, "text");
        require_index(index, object->list.size(), "index");
        *subject = object->list[index].subject.c_str();
        *text = object->list[index].what.c_str();
    });
}
