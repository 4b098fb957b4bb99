// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include "earshot/base/assert.h"
#include "earshot/collision/internal/mesh_motion.h"
#include "earshot/collision/internal/world_state.h"

#include <algorithm>
#include <cmath>
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

/// Whether the boxes around two meshes overlap.
bool bounds_overlap(const Shape& a, const Shape& b) {
    if (a.nodes().empty() || b.nodes().empty()) {
        return false;
    }
    const BoxNode& one = a.nodes().front();
    const BoxNode& other = b.nodes().front();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double gap = std::abs(static_cast<double>(one.centre[axis][0]) -
                                    static_cast<double>(other.centre[axis][0]));
        // The sum of two floats is exact in doubles or rounded by less than this factor.
        const double half_sum =
            (static_cast<double>(one.half[axis][0]) + static_cast<double>(other.half[axis][0])) *
            (1.0 + 0x1p-50);
        if (gap * (1.0 - 0x1p-50) > half_sum) {
            return false;
        }
    }
    return true;
}

}  // namespace

WorldStatistics& WorldStatistics::operator+=(const WorldStatistics& other) noexcept {
    box_tests += other.box_tests;
    triangle_pairs += other.triangle_pairs;
    elementary_tests += other.elementary_tests;
    return *this;
}

World::World(bvh::Builder builder) : state_(std::make_unique<State>()) {
    state_->swept_bvh = SweptBvh(builder);
    state_->builder = builder;
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

std::uint32_t World::add_mesh(std::span<const Triangle> triangles, std::size_t vertices) {
    State& state = *state_;
    state.scene.add(triangles, vertices);
    // Shapes hold views of arrays that may have been reallocated.
    state.at_begin.clear();
    state.at_begin.resize(state.scene.meshes());
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
    const auto parts = static_cast<double>(state.parts_of_step);
    for (std::size_t part = 0; part < state.parts_of_step; ++part) {
        state.move_to_part(part);
        for (Contact& contact : state.search(options, executor)) {
            // Rounded down: never late.
            contact.toi = (static_cast<double>(part) + contact.toi) / parts * (1.0 - 0x1p-50);
            contacts.push_back(contact);
        }
    }
    state.move_to_part(0);
    keep_first_of_each_pair(contacts);
    return contacts;
}

std::vector<Contact> World::contacts_at_begin(const ContactOptions& options, Executor& executor) {
    State& state = *state_;
    const std::uint32_t meshes = state.scene.meshes();
    std::vector<Contact> contacts;
    for (std::uint32_t a = 0; a < meshes; ++a) {
        for (std::uint32_t b = a; b < meshes; ++b) {
            if (!options.accepts(a, b)) {
                continue;
            }
            const Shape& one = state.shape_at_begin(a, executor);
            const Shape& other = state.shape_at_begin(b, executor);
            if (!bounds_overlap(one, other)) {
                continue;
            }
            const auto pairs = a == b ? find_self_contacts({one}, executor)
                                      : find_contacts({one}, {other}, executor);
            const std::size_t first = contacts.size();
            contacts.resize(first + pairs.size());
            executor.for_each(pairs.size(), 1024, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    contacts[first + i] = state.contact_at_begin(a, b, pairs[i]);
                }
            });
        }
    }
    std::sort(contacts.begin(), contacts.end());
    return contacts;
}

MeshDistance World::distance_at_begin(std::uint32_t a, std::uint32_t b, Executor& executor) {
    State& state = *state_;
    EARSHOT_ASSERT(a < state.scene.meshes() && b < state.scene.meshes());
    return distance({state.shape_at_begin(a, executor)}, {state.shape_at_begin(b, executor)});
}

std::optional<SolidDepth> World::depth_at_begin(std::uint32_t a, std::uint32_t b) {
    State& state = *state_;
    EARSHOT_ASSERT(a < state.scene.meshes() && b < state.scene.meshes());
    const std::span<const ConvexPart> one = state.convex_parts_at_begin(a);
    return a == b ? self_penetration_depth(one, {})
                  : penetration_depth(one, {}, state.convex_parts_at_begin(b), {});
}

std::optional<Contact> World::first_contact(const ContactOptions& options, Executor& executor) {
    const std::vector<Contact> all = contacts(options, executor);
    return all.empty() ? std::nullopt : std::optional(all.front());
}

std::uint32_t World::mesh_count() const noexcept {
    return state_->scene.meshes();
}

const WorldStatistics& World::statistics() const noexcept {
    return state_->statistics;
}

}  // namespace earshot::collision
