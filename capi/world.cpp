// SPDX-License-Identifier: MIT
// Worlds: meshes and how they move.
#include "earshot/base/parallel.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/capi/internal/world_object.h"

#include <glm/geometric.hpp>

#include <memory>
#include <string>

namespace earshot::capi {
namespace {

/// A mesh that the program moves: not one of a scene.
void require_own_mesh(const WorldObject& world, std::uint32_t mesh, std::size_t vertex_count) {
    const WorldObject::Mesh& known = require_mesh(world, mesh, "mesh");
    if (known.of_scene) {
        fail_argument("mesh",
                      "is " + std::to_string(mesh) + ", a mesh of a scene",
                      "es_world_set_time_step() moves it");
    }
    require_size(vertex_count, known.vertices, "vertex_count");
}

void require_room_for_mesh(const WorldObject& world, std::size_t more) {
    constexpr std::size_t kMaxMeshes = 1U << 24U;
    if (world.meshes.size() + more > kMaxMeshes) {
        fail_argument("world", "would have more than 2^24 meshes", "make another world");
    }
}

}  // namespace

const WorldObject::Mesh& require_mesh(const WorldObject& world,
                                      std::uint32_t mesh,
                                      const char* argument) {
    require_index(mesh, world.meshes.size(), argument);
    if (world.meshes[mesh].is_removed) {
        throw Failure(ES_ERROR_INDEX,
                      argument,
                      "is " + std::to_string(mesh) + ", a mesh that was removed",
                      "give the number of one that is there");
    }
    return world.meshes[mesh];
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_world_create(es_world* world) {
    return call(__func__, [&] {
        require(world, "world");
        *world = publish(std::make_shared<WorldObject>());
    });
}

es_status es_world_add_mesh(es_world world,
                            const char* name,
                            const double* vertices,
                            size_t vertex_count,
                            const uint32_t* triangles,
                            size_t triangle_count,
                            uint32_t* mesh) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require(mesh, "mesh");
        require_room_for_mesh(*object, 1);
        const std::string named(text_or(name, "", "name"));
        const auto positions = require_points(vertices, vertex_count, "vertices");
        const auto faces = require_triangles(triangles, triangle_count, vertex_count, "triangles");
        object->meshes.reserve(object->meshes.size() + 1);
        const std::uint32_t number = object->world.add_mesh(faces, vertex_count);
        object->meshes.push_back({.name = named, .vertices = vertex_count});
        object->world.update(number, positions, positions);
        *mesh = number;
    });
}

es_status es_world_add_scene(es_world world, es_scene scene, int32_t weld, uint32_t* first) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        const Reading<SceneObject> from(scene, "scene");
        require(first, "first");
        require_flag(weld, "weld");
        const geometry::AnimatedMesh& mesh = from->loaded.scene.mesh;
        require_room_for_mesh(*object, mesh.mesh_names().size());
        object->meshes.reserve(object->meshes.size() + mesh.mesh_names().size());
        const std::uint32_t number = object->world.add(mesh, weld != 0);
        for (const std::string& name : mesh.mesh_names()) {
            object->meshes.push_back({.name = name, .of_scene = true});
        }
        object->world.set_step(0.0, 0.0);
        *first = number;
    });
}

es_status es_world_remove_mesh(es_world world, uint32_t mesh) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        static_cast<void>(require_mesh(*object, mesh, "mesh"));
        object->world.remove_mesh(mesh);
        object->meshes[mesh].is_removed = true;
    });
}

es_status es_world_mesh_count(es_world world, size_t* count) {
    return call(__func__, [&] {
        const Reading<WorldObject> object(world, "world");
        require(count, "count") = object->meshes.size();
    });
}

es_status es_world_mesh_name(es_world world, uint32_t mesh, const char** name) {
    return call(__func__, [&] {
        const Reading<WorldObject> object(world, "world");
        require(name, "name");
        require_index(mesh, object->meshes.size(), "mesh");
        *name = object->meshes[mesh].name.c_str();
    });
}

es_status es_world_step_mesh(
    es_world world, uint32_t mesh, const double* begin, const double* end, size_t vertex_count) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require_own_mesh(*object, mesh, vertex_count);
        const auto from = require_points(begin, vertex_count, "begin");
        object->world.update(
            mesh, from, end == nullptr ? from : require_points(end, vertex_count, "end"));
    });
}

es_status es_world_step_screw(es_world world,
                              uint32_t mesh,
                              const double* begin,
                              size_t vertex_count,
                              const double point[3],
                              const double axis[3],
                              double angle,
                              double slide) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require_own_mesh(*object, mesh, vertex_count);
        const auto from = require_points(begin, vertex_count, "begin");
        const geometry::Vec3 through = require_point(point, "point");
        const geometry::Vec3 along = require_point(axis, "axis");
        constexpr double kMaxAngle = 1e3, kShort = 1e-100;
        require_in(angle, -kMaxAngle, kMaxAngle, "angle");
        require_in(slide, -kMaxCoordinate, kMaxCoordinate, "slide");
        const double largest = std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)});
        if (!(largest > kShort)) {
            fail_argument("axis", "has no length", "give a direction");
        }
        object->world.update(mesh,
                             from,
                             collision::Screw{.point = through,
                                              .axis = glm::normalize(along / largest),
                                              .angle = angle,
                                              .slide = slide});
    });
}

es_status es_world_set_time_step(es_world world, double t0, double t1, int32_t rigid) {
    return call(__func__, [&] {
        const Changing<WorldObject> object(world, "world");
        require_time(t0, "t0");
        require_time(t1, "t1");
        require_flag(rigid, "rigid");
        object->world.set_step(
            t0, t1, rigid != 0 ? collision::Path::screws : collision::Path::chords);
    });
}
