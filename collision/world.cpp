// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/collision/broad_phase/internal/bvtt_front.h"
#include "earshot/collision/broad_phase/internal/leaf_slabs.h"
#include "earshot/collision/broad_phase/internal/normal_cones.h"
#include "earshot/collision/broad_phase/internal/representatives.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/narrow_phase/internal/element_tester.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

enum class ShapeAge : std::uint8_t { none, outdated, current };

struct World::State {
    MovingScene scene;
    bvh::Builder builder = bvh::Builder::binned_sah;
    SweptBvh swept_bvh;
    LeafSlabs leaf_slabs;
    NormalCones normal_cones;
    bool has_normal_cones = false;  // whether they were built for the present tree
    BvttFront front;
    std::vector<std::uint8_t> representatives, all;  // see representatives.h
    std::vector<Shape> shapes;  // BVHs of meshes at the beginning of the step, built on demand
    std::vector<ShapeAge> shape_ages;
    WorldStatistics statistics;

    void follow(const ContactOptions& options, Executor& executor);
    const NormalCones* normal_cones_for(const ContactOptions& options, Executor& executor);
    const Shape& shape_at_begin(std::uint32_t mesh, Executor& executor);
    Contact contact_at_begin(std::uint32_t mesh_a, std::uint32_t mesh_b, TrianglePair pair) const;
};

void World::State::follow(const ContactOptions& options, Executor& executor) {
    if (representatives.size() != scene.triangles.size()) {
        representatives = representative_features(scene.triangles);
        all = all_features(scene.triangles);
    }
    if (swept_bvh.update(scene, options.margin(), executor)) {
        front.reset();
        has_normal_cones = false;
        leaf_slabs.build(scene, swept_bvh);
    }
    leaf_slabs.update(scene, swept_bvh, options.margin(), executor);
}

const NormalCones* World::State::normal_cones_for(const ContactOptions& options,
                                                  Executor& executor) {
    // A node without self-contact may still hold elements closer than the separation.
    if (!options.within_meshes || !options.cull_with_normal_cones || options.min_separation > 0.0) {
        return nullptr;
    }
    if (!has_normal_cones) {
        normal_cones.build(scene, swept_bvh);
        has_normal_cones = true;
    }
    normal_cones.update(scene, swept_bvh, executor);
    return &normal_cones;
}

const Shape& World::State::shape_at_begin(std::uint32_t mesh, Executor& executor) {
    const geometry::MeshView view{scene.begin, scene.triangles_of(mesh)};
    if (shape_ages[mesh] == ShapeAge::none) {
        shapes[mesh] = Shape::build(view, {.builder = builder}, executor);
    } else if (shape_ages[mesh] == ShapeAge::outdated) {
        shapes[mesh].refit(view);
    }
    shape_ages[mesh] = ShapeAge::current;
    return shapes[mesh];
}

Contact World::State::contact_at_begin(std::uint32_t mesh_a,
                                       std::uint32_t mesh_b,
                                       TrianglePair pair) const {
    const Triangle& a = scene.triangles_of(mesh_a)[pair.a];
    const Triangle& b = scene.triangles_of(mesh_b)[pair.b];
    const std::vector<Vec3>& begin = scene.begin;
    const Corners one = geometry::corners(begin, a);
    const Corners other = geometry::corners(begin, b);
    Contact contact{.kind = ContactKind::triangle_triangle,
                    .a = scene.element(mesh_a, a),
                    .b = scene.element(mesh_b, b)};
    if (const auto segment = intersection(one, other)) {
        contact.point = 0.5 * (segment->from + segment->to);
    }
    contact.normal =
        geometry::normalized_or_zero(glm::cross(other[1] - other[0], other[2] - other[0]));
    if (glm::dot(contact.normal, (one[0] + one[1] + one[2]) / 3.0 - other[0]) < 0.0) {
        contact.normal = -contact.normal;
    }
    return contact;
}

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
    state.shapes.assign(state.scene.meshes(), {});
    state.shape_ages.assign(state.scene.meshes(), ShapeAge::none);
    return state.scene.meshes() - 1;
}

void World::update(std::uint32_t mesh, std::span<const Vec3> begin, std::span<const Vec3> end) {
    MovingScene& scene = state_->scene;
    EARSHOT_ASSERT(mesh < scene.meshes() && begin.size() == end.size());
    const auto is_finite = [](const Vec3& point) { return geometry::is_finite(point); };
    if (!std::all_of(begin.begin(), begin.end(), is_finite) ||
        !std::all_of(end.begin(), end.end(), is_finite)) {
        throw Error(
            "mesh " + std::to_string(mesh), "a position is not finite", "check the positions");
    }
    const VertexId first = scene.first_vertex[mesh];
    EARSHOT_ASSERT(first + begin.size() == scene.first_vertex[mesh + 1]);
    std::copy(begin.begin(), begin.end(), scene.begin.begin() + first);
    std::copy(end.begin(), end.end(), scene.end.begin() + first);
    ShapeAge& age = state_->shape_ages[mesh];
    age = age == ShapeAge::none ? age : ShapeAge::outdated;
}

std::vector<Contact> World::contacts(const ContactOptions& options, Executor& executor) {
    State& state = *state_;
    state.statistics = {};
    if (state.scene.triangles.empty()) {
        return {};
    }
    state.follow(options, executor);
    const NormalCones* normal_cones = state.normal_cones_for(options, executor);
    const auto& elements = options.assign_representatives ? state.representatives : state.all;
    const auto new_tester = [&] {
        return ElementTester(
            state.scene, state.swept_bvh, state.leaf_slabs, normal_cones, elements, options);
    };
    ElementTester first = new_tester();
    SelfTraversal<ElementTester> top(state.swept_bvh, first);
    state.front.prepare(state.swept_bvh.tree(), options.track_front, top);
    state.statistics.box_tests = top.box_tests();

    struct Findings {
        std::vector<Contact> contacts;
        WorldStatistics statistics;
    };
    std::vector<Findings> findings(state.front.size());
    executor.for_each(state.front.size(), 1, [&](std::size_t index, std::size_t) {
        ElementTester tester = new_tester();
        SelfTraversal<ElementTester> traversal(state.swept_bvh, tester);
        traversal.run(state.front.subfront(index));
        findings[index] = {std::move(tester.contacts()), tester.statistics()};
        findings[index].statistics.box_tests = traversal.box_tests();
    });
    std::vector<Contact> contacts;
    for (const Findings& part : findings) {
        contacts.insert(contacts.end(), part.contacts.begin(), part.contacts.end());
        state.statistics += part.statistics;
    }
    std::sort(contacts.begin(), contacts.end());
    // Triangles that stand twice in a mesh give the same contact, and so do shared elements.
    const auto last =
        std::unique(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
            return x.kind == y.kind && x.a == y.a && x.b == y.b;
        });
    contacts.erase(last, contacts.end());
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
            const auto pairs = a == b ? find_self_contacts({one}, executor)
                                      : find_contacts({one}, {other}, executor);
            for (const TrianglePair& pair : pairs) {
                contacts.push_back(state.contact_at_begin(a, b, pair));
                if (contacts.back().b < contacts.back().a) {
                    std::swap(contacts.back().a, contacts.back().b);
                }
            }
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

std::optional<Contact> World::first_contact(const ContactOptions& options, Executor& executor) {
    const std::vector<Contact> all = contacts(options, executor);
    return all.empty() ? std::nullopt : std::optional(all.front());
}

const WorldStatistics& World::statistics() const noexcept {
    return state_->statistics;
}

}  // namespace earshot::collision
