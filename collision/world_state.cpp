// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/world_state.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/collision/broad_phase/internal/representatives.h"
#include "earshot/collision/internal/mesh_motion.h"
#include "earshot/collision/narrow_phase/internal/element_tester.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"
#include "earshot/geometry/predicates.h"
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

namespace {

void require_finite(std::uint32_t mesh, std::span<const Vec3> positions) {
    const auto is_finite = [](const Vec3& position) { return geometry::is_finite(position); };
    if (!std::all_of(positions.begin(), positions.end(), is_finite)) {
        throw Error(
            "mesh " + std::to_string(mesh), "a position is not finite", "check the positions");
    }
}

}  // namespace

void World::State::set_begin(std::uint32_t mesh, std::span<const Vec3> positions) {
    EARSHOT_ASSERT(mesh < scene.meshes());
    require_finite(mesh, positions);
    const auto first = static_cast<std::ptrdiff_t>(scene.first_vertex[mesh]);
    EARSHOT_ASSERT(static_cast<std::size_t>(first) + positions.size() ==
                   scene.first_vertex[mesh + 1]);
    std::transform(positions.begin(),
                   positions.end(),
                   scene.begin.begin() + first,
                   geometry::without_tiny_coordinates);
    if (scene.screws[mesh]) {
        scene.screws[mesh].reset();
        --scene.meshes_on_screws;
        std::fill_n(scene.deviation.begin() + first, positions.size(), 0.0);
    }
    at_begin[mesh].is_shape_current = false;
    at_begin[mesh].convex_parts.reset();
}

void World::State::move(std::uint32_t mesh,
                        std::span<const Vec3> begin,
                        std::span<const Vec3> end) {
    EARSHOT_ASSERT(begin.size() == end.size());
    require_finite(mesh, end);
    set_begin(mesh, begin);
    std::transform(end.begin(),
                   end.end(),
                   scene.end.begin() + static_cast<std::ptrdiff_t>(scene.first_vertex[mesh]),
                   geometry::without_tiny_coordinates);
}

void World::State::move(std::uint32_t mesh, std::span<const Vec3> begin, const Screw& screw) {
    set_begin(mesh, begin);
    scene.screws[mesh] = screw;
    ++scene.meshes_on_screws;
    const VertexId first = scene.first_vertex[mesh];
    const VertexId last = scene.first_vertex[mesh + 1];
    for (VertexId vertex = first; vertex < last; ++vertex) {
        scene.end[vertex] = screw.apply(scene.begin[vertex], 1.0);
        scene.deviation[vertex] = screw.chord_deviation(scene.begin[vertex]);
    }
    require_finite(mesh, std::span(scene.end).subspan(first, last - first));
}

void World::State::move_to_part(std::size_t part) {
    const double from = instant_within(t0, t1, part, parts_of_step);
    const double to = instant_within(t0, t1, part + 1, parts_of_step);
    for (const AddedScene& each : added) {
        const std::vector<Vec3> begin = each.meshes.scene().positions_at(from);
        const std::vector<Vec3> end = from == to ? begin : each.meshes.scene().positions_at(to);
        for (std::uint32_t i = 0; i < each.meshes.size(); ++i) {
            const auto screw = path == Path::screws && from != to
                                   ? screw_between(each.meshes, i, from, to)
                                   : std::nullopt;
            if (screw) {
                move(each.first_mesh + i, each.meshes.positions(i, begin), *screw);
            } else {
                move(each.first_mesh + i,
                     each.meshes.positions(i, begin),
                     each.meshes.positions(i, end));
            }
        }
    }
}

void World::State::update_broad_phase(const ContactOptions& options, Executor& executor) {
    if (representatives.size() != scene.triangles.size()) {
        representatives = representative_features(scene.triangles);
        all = all_features(scene.triangles);
    }
    if (swept_bvh.update(scene, options.margin(), executor)) {
        front.reset();
        has_normal_cones = false;
        leaf_slabs.build(scene, swept_bvh);
    }
    const double deviation =
        scene.meshes_on_screws == 0
            ? 0.0
            : *std::max_element(scene.deviation.begin(), scene.deviation.end());
    leaf_slabs.update(scene, swept_bvh, options.margin() + deviation, executor);
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

std::vector<Contact> World::State::search(const ContactOptions& options, Executor& executor) {
    // 1. The broad phase follows the step; the front is begun anew where needed.
    update_broad_phase(options, executor);
    const NormalCones* cones = normal_cones_for(options, executor);
    const auto& elements = options.assign_representatives ? representatives : all;
    const auto new_tester = [&] {
        return ElementTester(scene, swept_bvh, leaf_slabs, cones, elements, options);
    };
    ElementTester first = new_tester();
    SelfTraversal<ElementTester> top(swept_bvh, first);
    front.prepare(swept_bvh.tree(), options.track_front, top);
    statistics.box_tests += top.box_tests();

    // 2. Traversal from each sub-front, with the narrow phase at its leaves.
    struct Findings {
        std::vector<Contact> contacts;
        WorldStatistics statistics;
    };
    std::vector<Findings> findings(front.size());
    executor.for_each(front.size(), 1, [&](std::size_t index, std::size_t) {
        ElementTester tester = new_tester();
        SelfTraversal<ElementTester> traversal(swept_bvh, tester);
        traversal.run(front.subfront(index));
        findings[index] = {std::move(tester.contacts()), tester.statistics()};
        findings[index].statistics.box_tests = traversal.box_tests();
    });

    // 3. All contacts in order, each once: triangles that occur twice in a mesh give the same
    // contacts, and so do elements without representative triangles.
    std::vector<Contact> contacts;
    for (const Findings& each : findings) {
        contacts.insert(contacts.end(), each.contacts.begin(), each.contacts.end());
        statistics += each.statistics;
    }
    std::sort(contacts.begin(), contacts.end());
    const auto last =
        std::unique(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
            return x.kind == y.kind && x.a == y.a && x.b == y.b;
        });
    contacts.erase(last, contacts.end());
    return contacts;
}

const Shape& World::State::shape_at_begin(std::uint32_t mesh, Executor& executor) {
    const geometry::MeshView view{scene.begin, scene.triangles_of(mesh)};
    MeshAtBegin& kept = at_begin[mesh];
    if (!kept.has_shape) {
        kept.shape = Shape::build(view, {.builder = builder}, executor);
    } else if (!kept.is_shape_current) {
        kept.shape.refit(view);
    }
    kept.has_shape = kept.is_shape_current = true;
    return kept.shape;
}

std::span<const ConvexPart> World::State::convex_parts_at_begin(std::uint32_t mesh) {
    std::optional<std::vector<ConvexPart>>& parts = at_begin[mesh].convex_parts;
    if (!parts) {
        parts = convex_parts({scene.begin, scene.triangles_of(mesh)});
    }
    return *parts;
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
    if (contact.b < contact.a) {
        std::swap(contact.a, contact.b);
    }
    return contact;
}

}  // namespace earshot::collision
