// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include "earshot/base/assert.h"
#include "earshot/collision/internal/mesh_motion.h"
#include "earshot/collision/internal/world_state.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;

namespace {

/// Keeps the first contact of each pair of elements, of contacts in the order of time.
void keep_first_of_each_pair(std::vector<Contact>& contacts) {
    std::stable_sort(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
        return std::tie(x.kind, x.a, x.b) < std::tie(y.kind, y.a, y.b);
    });
    const auto last =
        std::unique(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
            return std::tie(x.kind, x.a, x.b) == std::tie(y.kind, y.a, y.b);
        });
    contacts.erase(last, contacts.end());
    std::sort(contacts.begin(), contacts.end());
}

}  // namespace

World::World(bvh::Builder builder) : state_(std::make_unique<State>()) {
    state_->swept = SweptBroadPhase(builder);
    state_->instant = InstantBroadPhase(builder);
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::uint32_t World::add_mesh(std::span<const Triangle> triangles, std::size_t vertices) {
    State& state = *state_;
    state.scene.add(triangles, vertices);
    state.convex.resize(state.scene.meshes());
    return state.scene.meshes() - 1;
}

std::uint32_t World::add(geometry::AnimatedMesh scene, bool weld) {
    AddedScene added{SceneMeshes(std::move(scene), weld), state_->scene.meshes()};
    for (std::uint32_t mesh = 0; mesh < added.meshes.size(); ++mesh) {
        add_mesh(added.meshes.triangles(mesh), added.meshes.vertex_count(mesh));
    }
    state_->added.push_back(std::move(added));
    return state_->added.back().first_mesh;
}

void World::remove_mesh(std::uint32_t mesh) {
    State& state = *state_;
    EARSHOT_ASSERT(mesh < state.scene.meshes() && state.scene.is_removed[mesh] == 0);
    state.scene.remove(mesh);
    state.convex[mesh].reset();
}

void World::set_step(double t0, double t1, Path path) {
    State& state = *state_;
    state.t0 = t0;
    state.t1 = t1;
    state.path = path;
    state.parts_of_step = 1;
    for (const AddedScene& added : state.added) {
        if (path == Path::screws && t0 != t1) {
            state.parts_of_step = std::max(state.parts_of_step, screw_steps(added.meshes, t0, t1));
        }
    }
    state.move_to_part(0);
}

bool World::moves(std::uint32_t mesh) const noexcept {
    const MovingScene& scene = state_->scene;
    EARSHOT_ASSERT(mesh < scene.meshes());
    const auto first = static_cast<std::ptrdiff_t>(scene.first_vertex[mesh]);
    const auto last = static_cast<std::ptrdiff_t>(scene.first_vertex[mesh + 1]);
    return !std::equal(
        scene.begin.begin() + first, scene.begin.begin() + last, scene.end.begin() + first);
}

double World::turn(std::uint32_t mesh, double t0, double t1) const {
    for (const AddedScene& added : state_->added) {
        if (mesh >= added.first_mesh && mesh - added.first_mesh < added.meshes.size()) {
            return turn_of(added.meshes, mesh - added.first_mesh, t0, t1);
        }
    }
    return 0.0;
}

void World::update(std::uint32_t mesh, std::span<const Vec3> begin, std::span<const Vec3> end) {
    state_->move(mesh, begin, end);
}

void World::update(std::uint32_t mesh, std::span<const Vec3> begin, const Screw& screw) {
    state_->move(mesh, begin, screw);
}

std::vector<Contact> World::contacts(const ContactOptions& options, Executor& executor) {
    State& state = *state_;
    state.statistics = {};
    if (state.scene.triangles.empty()) {
        return {};
    }
    if (state.parts_of_step == 1) {
        return state.search(options, executor);
    }
    std::vector<Contact> contacts;
    for (std::size_t part = 0; part < state.parts_of_step; ++part) {
        state.move_to_part(part);
        for (Contact& contact : state.search(options, executor)) {
            contact.toi = state.time_within_step(part, contact.toi);
            contacts.push_back(contact);
        }
    }
    state.move_to_part(0);
    keep_first_of_each_pair(contacts);
    return contacts;
}

std::vector<Contact> World::contacts_at_begin(const ContactOptions& options, Executor& executor) {
    state_->statistics = {};
    std::vector<Contact> contacts = state_->search_at_begin(options, executor);
    std::sort(contacts.begin(), contacts.end());
    return contacts;
}

MeshDistance World::distance_at_begin(std::uint32_t a, std::uint32_t b, Executor& executor) {
    State& state = *state_;
    EARSHOT_ASSERT(a < state.scene.meshes() && b < state.scene.meshes());
    state.statistics = {};
    state.instant.update_shapes(state.scene, std::array{a, b}, executor, state.statistics);
    const InstantDistance result =
        search_distance({state.instant.shape(a)}, {state.instant.shape(b)});
    state.statistics += result.statistics;
    state.instant.add_work(a, result.statistics);
    state.instant.add_work(b, result.statistics);
    return result.distance;
}

std::optional<SolidDepth> World::depth_at_begin(std::uint32_t a, std::uint32_t b) {
    State& state = *state_;
    EARSHOT_ASSERT(a < state.scene.meshes() && b < state.scene.meshes());
    const std::span<const ConvexPart> one = state.convex_parts_at_begin(a);
    return a == b ? self_penetration_depth(one, {})
                  : penetration_depth(one, {}, state.convex_parts_at_begin(b), {});
}

std::optional<Contact> World::first_contact(const ContactOptions& options, Executor& executor) {
    State& state = *state_;
    state.statistics = {};
    if (state.scene.triangles.empty()) {
        return std::nullopt;
    }
    if (state.parts_of_step == 1) {
        return state.search_first(options, executor);
    }
    // Times of a part end where those of the next begin, and rounding may make them equal.
    std::optional<Contact> first;
    for (std::size_t part = 0; part < state.parts_of_step; ++part) {
        if (first && first->toi < state.time_within_step(part, 0.0)) {
            break;
        }
        state.move_to_part(part);
        for (Contact& contact : state.search(options, executor)) {
            contact.toi = state.time_within_step(part, contact.toi);
            if (!first || contact < *first) {
                first = contact;
            }
        }
    }
    state.move_to_part(0);
    return first;
}

std::uint32_t World::mesh_count() const noexcept {
    return state_->scene.meshes();
}

const WorldStatistics& World::statistics() const noexcept {
    return state_->statistics;
}

}  // namespace earshot::collision
