// SPDX-License-Identifier: MIT
//
// Worlds of many meshes, of meshes that come and go, and what is kept of them from step to step.

#include "earshot/collision/narrow_phase/triangle_intersection.h"
#include "earshot/collision/world.h"

#include <gtest/gtest.h>

#include "support/collision_sequences.h"
#include "support/dice.h"
#include "support/moving_meshes.h"
#include "support/query_meshes.h"
#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::Mesh;
using geometry::Triangle;
using geometry::Vec3;
using support::Dice;

/// The faces of two meshes, of each the vertices.
using FacePair = std::pair<Element, Element>;

std::set<FacePair> faces_of(const std::vector<Contact>& contacts) {
    std::set<FacePair> result;
    for (const Contact& contact : contacts) {
        EXPECT_EQ(contact.kind, ContactKind::triangle_triangle);
        EXPECT_EQ(contact.toi, 0.0);
        EXPECT_TRUE(result.insert({contact.a, contact.b}).second);
    }
    return result;
}

/// All triangles against all, but those of one mesh.
std::set<FacePair> all_pairs(const std::vector<MovingMesh>& meshes) {
    std::set<FacePair> result;
    for (std::uint32_t m = 0; m < meshes.size(); ++m) {
        for (std::uint32_t n = m + 1; n < meshes.size(); ++n) {
            for (const Triangle& t : meshes[m].triangles) {
                for (const Triangle& u : meshes[n].triangles) {
                    if (intersect(geometry::corners(meshes[m].begin, t),
                                  geometry::corners(meshes[n].begin, u))) {
                        result.insert(
                            {element(m, {t[0], t[1], t[2]}), element(n, {u[0], u[1], u[2]})});
                    }
                }
            }
        }
    }
    return result;
}

MovingMesh moving(const Mesh& mesh, const Vec3& place, const Vec3& motion) {
    MovingMesh result{{mesh.triangles.begin(), mesh.triangles.end()}, {}, {}};
    for (const Vec3& position : mesh.positions) {
        result.begin.push_back(place + position);
        result.end.push_back(place + position + motion);
    }
    return result;
}

/// Cubes that fly about in a room; the larger it is the fewer touch.
std::vector<MovingMesh> cubes(std::size_t count, double room, Dice& dice) {
    std::vector<MovingMesh> meshes;
    for (std::size_t i = 0; i < count; ++i) {
        const auto point = [&](double far) {
            return Vec3(dice.between(-far, far), dice.between(-far, far), dice.between(-far, far));
        };
        const Vec3 place = point(room);
        meshes.push_back(moving(test::cube(1, 0.5), place, point(1.0)));
    }
    return meshes;
}

void step(std::vector<MovingMesh>& meshes, Dice& dice) {
    for (MovingMesh& mesh : meshes) {
        const Vec3 motion(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1));
        mesh.begin = mesh.end;
        for (Vec3& position : mesh.end) {
            position += motion;
        }
    }
}

TEST(WorldMeshes, AtAnInstantAreFoundAsByAllPairs) {
    for (const double room : {2.0, 5.0, 30.0}) {
        Dice dice(3);
        std::vector<MovingMesh> meshes = cubes(90, room, dice);
        World world = world_of(meshes);
        for (int i = 0; i < 8; ++i) {
            Executor executor(1 + i % 3);
            EXPECT_EQ(faces_of(world.contacts_at_begin({}, executor)), all_pairs(meshes)) << i;
            step(meshes, dice);
            for (std::uint32_t m = 0; m < meshes.size(); ++m) {
                world.update(m, meshes[m].begin, meshes[m].end);
            }
        }
    }
}

TEST(WorldMeshes, ThatAreApartAreNotTestedPairByPair) {
    // So far apart that no boxes overlap; all pairs would be 79,800 tests.
    std::vector<MovingMesh> meshes;
    for (int i = 0; i < 400; ++i) {
        meshes.push_back(moving(test::cube(1, 0.5), Vec3(2.0 * i, 3.0 * (i % 7), 0.0), Vec3(0.0)));
    }
    World world = world_of(meshes);
    EXPECT_TRUE(world.contacts_at_begin().empty());
    EXPECT_EQ(world.statistics().triangle_pairs, 0U);
    EXPECT_GT(world.statistics().box_tests, 400U);
    EXPECT_LT(world.statistics().box_tests, 8000U);
}

TEST(WorldMeshes, AreGoneWhenTheyWereRemoved) {
    Dice dice(5);
    std::vector<MovingMesh> meshes = cubes(24, 1.6, dice);
    World world = world_of(meshes);
    for (const std::uint32_t gone : {7U, 0U, 23U, 8U}) {
        EXPECT_FALSE(world.contacts().empty());
        EXPECT_FALSE(world.contacts_at_begin().empty());
        world.remove_mesh(gone);
        meshes[gone] = {};
        EXPECT_EQ(world.mesh_count(), meshes.size());
        EXPECT_FALSE(world.moves(gone));
        std::set<Found> set;
        for (const Contact& contact : world.contacts({.within_meshes = true})) {
            set.insert(found(contact));
        }
        EXPECT_EQ(set, brute_force(meshes, true, true)) << gone;
        EXPECT_EQ(faces_of(world.contacts_at_begin()), all_pairs(meshes)) << gone;
        // The others move on, and one more comes.
        step(meshes, dice);
        meshes.push_back(cubes(1, 0.5, dice).front());
        EXPECT_EQ(world.add_mesh(meshes.back().triangles, meshes.back().begin.size()),
                  meshes.size() - 1);
        for (std::uint32_t m = 0; m < meshes.size(); ++m) {
            if (!meshes[m].triangles.empty()) {
                world.update(m, meshes[m].begin, meshes[m].end);
            }
        }
        EXPECT_EQ(faces_of(world.contacts_at_begin()), all_pairs(meshes)) << gone;
    }
}

TEST(WorldMeshes, FirstContactIsTheFirstOfAllAndTestsLess) {
    Dice dice(9);
    std::uint64_t tests = 0, tests_of_all = 0;
    for (int i = 0; i < 30; ++i) {
        const std::vector<MovingMesh> meshes = cubes(60, 2.0 + 0.5 * (i % 9), dice);
        World world = world_of(meshes);
        const auto all = world.contacts();
        tests_of_all += world.statistics().elementary_tests;
        std::vector<std::uint64_t> counts;
        for (const int threads : {1, 2, 8}) {
            Executor executor(threads);
            const auto first = world.first_contact({}, executor);
            counts.push_back(world.statistics().elementary_tests);
            ASSERT_EQ(first.has_value(), !all.empty());
            if (first) {
                EXPECT_EQ(found(*first), found(all.front()));
                EXPECT_EQ(first->point, all.front().point);
                EXPECT_EQ(first->normal, all.front().normal);
            }
        }
        EXPECT_EQ(counts[0], counts[1]);
        EXPECT_EQ(counts[0], counts[2]);
        tests += counts[0];
    }
    EXPECT_LT(tests, tests_of_all / 2);
}

/// Triangles that drift apart, each its own way, and lie anywhere in the end.
struct Drift {
    Mesh mesh = test::sphere(4, 1.0, Vec3(0.0));
    std::vector<Vec3> velocities;

    Drift() {
        Mesh split;
        Dice dice(11);
        for (const Triangle& t : mesh.triangles) {
            const auto first = static_cast<geometry::VertexId>(split.positions.size());
            split.triangles.push_back({first, first + 1, first + 2});
            velocities.emplace_back(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1));
            for (const geometry::VertexId vertex : t) {
                split.positions.push_back(mesh.positions[vertex]);
            }
        }
        mesh = split;
    }

    std::vector<Vec3> at(double time) const {
        std::vector<Vec3> positions = mesh.positions;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            positions[i] += time * velocities[i / 3];
        }
        return positions;
    }
};

TEST(WorldMeshes, ThatDriftApartAreNotRefittedForEver) {
    const Drift drift;
    World kept;
    kept.add_mesh(drift.mesh.triangles, drift.mesh.positions.size());
    WorldStatistics all;
    for (int i = 0; i <= 12; ++i) {
        const auto now = drift.at(0.06 * std::min(i, 8));
        kept.update(0, now, now);
        World fresh;
        fresh.add_mesh(drift.mesh.triangles, drift.mesh.positions.size());
        fresh.update(0, now, now);
        const ContactOptions options{.within_meshes = true};
        const auto contacts = kept.contacts_at_begin(options);
        EXPECT_EQ(faces_of(contacts), faces_of(fresh.contacts_at_begin(options))) << i;
        all += kept.statistics();
        // They rest from the ninth instant on; what a rebuild costs is soon more than paid.
        if (i > 10) {
            EXPECT_LT(2 * kept.statistics().box_tests, 3 * fresh.statistics().box_tests) << i;
        }
    }
    EXPECT_EQ(all.updates.refits + all.updates.repairs + all.updates.rebuilds, 2U * 12U);
    EXPECT_GT(all.updates.repairs + all.updates.rebuilds, 0U);
}

TEST(WorldMeshes, CountTheSameWorkForAnyNumberOfThreads) {
    const std::vector<support::Part> parts = support::flying_balls(12, 16, 10);
    const auto works = [&](int threads, bool at_begin) {
        World world;
        for (const support::Part& part : parts) {
            world.add_mesh(part.triangles, part.at(0.0).size());
        }
        Executor executor(threads);
        std::vector<std::uint64_t> counts;
        for (int frame = 0; frame < 6; ++frame) {
            for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
                world.update(mesh, parts[mesh].at(frame / 6.0), parts[mesh].at((frame + 1) / 6.0));
            }
            const ContactOptions options{.within_meshes = true};
            at_begin ? world.contacts_at_begin(options, executor)
                     : world.contacts(options, executor);
            const WorldStatistics& s = world.statistics();
            counts.insert(counts.end(),
                          {s.box_tests,
                           s.triangle_pairs,
                           s.elementary_tests,
                           s.front_nodes,
                           s.updates.refits,
                           s.updates.repairs,
                           s.updates.rebuilds});
        }
        return counts;
    };
    for (const bool at_begin : {false, true}) {
        const auto one = works(1, at_begin);
        EXPECT_GT(*std::max_element(one.begin(), one.end()), 1000U);
        EXPECT_EQ(works(2, at_begin), one);
        EXPECT_EQ(works(8, at_begin), one);
    }
}

}  // namespace
}  // namespace earshot::collision
