// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/world_state.h"

#include "earshot/collision/broad_phase/internal/representatives.h"
#include "earshot/collision/internal/mesh_motion.h"
#include "earshot/collision/narrow_phase/internal/element_tester.h"
#include "earshot/collision/narrow_phase/triangle_intersection.h"
#include "earshot/geometry/vector.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;

void World::State::note_update(std::uint32_t mesh, bool has_moved) {
    instant.note_update(mesh, has_moved);
    if (has_moved) {
        convex[mesh].reset();
    }
}

void World::State::move(std::uint32_t mesh,
                        std::span<const Vec3> begin,
                        std::span<const Vec3> end) {
    note_update(mesh, scene.move(mesh, begin, end));
}

void World::State::move(std::uint32_t mesh, std::span<const Vec3> begin, const Screw& screw) {
    note_update(mesh, scene.move(mesh, begin, screw));
}

void World::State::move_to_part(std::size_t part) {
    const double from = instant_within(t0, t1, part, parts_of_step);
    const double to = instant_within(t0, t1, part + 1, parts_of_step);
    for (const AddedScene& each : added) {
        const std::vector<Vec3> begin = each.meshes.scene().positions_at(from);
        const std::vector<Vec3> end = from == to ? begin : each.meshes.scene().positions_at(to);
        for (std::uint32_t i = 0; i < each.meshes.size(); ++i) {
            if (scene.is_removed[each.first_mesh + i] != 0) {
                continue;
            }
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

template <typename SetUp, typename Finish>
void World::State::test_step(const ContactOptions& options,
                             std::size_t round,
                             Executor& executor,
                             SetUp&& set_up,
                             Finish&& finish) {
    if (representatives_layout != scene.layout) {
        representatives = representative_features(scene.triangles);
        all = all_features(scene.triangles);
        representatives_layout = scene.layout;
    }
    swept.update(scene, options, executor, statistics);
    const auto new_tester = [&] {
        ElementTester tester(scene,
                             swept.swept_bvh(),
                             swept.leaf_slabs(),
                             swept.normal_cones(),
                             options.assign_representatives ? representatives : all,
                             options);
        set_up(tester);
        return tester;
    };
    swept.traverse(options, round, executor, statistics, new_tester, [&](ElementTester& tester) {
        statistics += tester.statistics();
        finish(tester);
    });
}

std::vector<Contact> World::State::search(const ContactOptions& options, Executor& executor) {
    std::vector<Contact> contacts;
    test_step(
        options,
        std::numeric_limits<std::size_t>::max(),
        executor,
        [](ElementTester&) {},
        [&](ElementTester& tester) {
            contacts.insert(contacts.end(), tester.contacts().begin(), tester.contacts().end());
        });
    // In order, each once: triangles that occur twice in a mesh give the same contacts, and so do
    // elements without representative triangles.
    std::sort(contacts.begin(), contacts.end());
    const auto last =
        std::unique(contacts.begin(), contacts.end(), [](const Contact& x, const Contact& y) {
            return x.kind == y.kind && x.a == y.a && x.b == y.b;
        });
    contacts.erase(last, contacts.end());
    return contacts;
}

std::optional<Contact> World::State::search_first(const ContactOptions& options,
                                                  Executor& executor) {
    // Few tasks a round, so that their contacts bound the times of those to come; the rounds do not
    // depend on the executor, so neither does the work.
    constexpr std::size_t kRound = 64;
    std::optional<Contact> first;
    test_step(
        options,
        kRound,
        executor,
        [&](ElementTester& tester) { tester.set_time_bound(first ? first->toi : 1.0); },
        [&](ElementTester& tester) {
            for (const Contact& contact : tester.contacts()) {
                if (!first || contact < *first) {
                    first = contact;
                }
            }
        });
    return first;
}

InstantContacts World::State::contacts_of_pair(const MeshPair& pair, Executor& executor) const {
    const Shape& a = instant.shape(pair.a);
    return pair.a == pair.b ? search_self_contacts({a}, executor)
                            : search_contacts({a}, {instant.shape(pair.b)}, executor);
}

void World::State::search_pairs(std::span<const MeshPair> pairs, Executor& executor) {
    // 1. Of pairs of which neither mesh has moved since the last search contacts are kept.
    std::vector<PairContacts> found(pairs.size());
    std::vector<std::size_t> moved;
    auto kept = pair_contacts.begin();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const MeshPair& pair = pairs[i];
        kept = std::lower_bound(
            kept, pair_contacts.end(), pair, [](const PairContacts& one, const MeshPair& other) {
                return one.pair < other;
            });
        const std::array poses{instant.pose(pair.a), instant.pose(pair.b)};
        if (kept != pair_contacts.end() && kept->pair == pair && kept->poses == poses) {
            found[i] = {pair, poses, {std::move(kept->contacts.pairs), {}}};
        } else {
            found[i] = {pair, poses, {}};
            moved.push_back(i);
        }
    }
    // 2. The others: few pairs of meshes each in parallel, many next to each other.
    constexpr std::size_t kManyPairs = 64;
    if (moved.size() < kManyPairs) {
        for (const std::size_t i : moved) {
            found[i].contacts = contacts_of_pair(pairs[i], executor);
        }
    } else {
        executor.for_each(moved.size(), 1, [&](std::size_t i, std::size_t) {
            found[moved[i]].contacts = contacts_of_pair(pairs[moved[i]], Executor::serial());
        });
    }
    pair_contacts = std::move(found);
}

std::vector<Contact> World::State::search_at_begin(const ContactOptions& options,
                                                   Executor& executor) {
    // 1. Pairs of meshes, and the shapes of those that are in any.
    const std::vector<MeshPair> pairs = instant.mesh_pairs(scene, options, executor, statistics);
    std::vector<std::uint32_t> meshes;
    for (const MeshPair& pair : pairs) {
        meshes.insert(meshes.end(), {pair.a, pair.b});
    }
    std::sort(meshes.begin(), meshes.end());
    meshes.erase(std::unique(meshes.begin(), meshes.end()), meshes.end());
    instant.update_shapes(scene, meshes, executor, statistics);

    // 2. Pairs of triangles.
    search_pairs(pairs, executor);

    // 3. Their contacts.
    std::vector<Contact> contacts;
    for (const PairContacts& found : pair_contacts) {
        const std::uint32_t a = found.pair.a;
        const std::uint32_t b = found.pair.b;
        statistics += found.contacts.statistics;
        instant.add_work(a, found.contacts.statistics);
        if (a != b) {
            instant.add_work(b, found.contacts.statistics);
        }
        const std::span<const TrianglePair> triangles = found.contacts.pairs;
        const std::size_t first = contacts.size();
        contacts.resize(first + triangles.size());
        executor.for_each(triangles.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                contacts[first + k] = contact_at_begin(a, b, triangles[k]);
            }
        });
    }
    return contacts;
}

std::span<const ConvexPart> World::State::convex_parts_at_begin(std::uint32_t mesh) {
    std::optional<std::vector<ConvexPart>>& parts = convex[mesh];
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
