// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include "earshot/base/error.h"
#include "earshot/base/simd.h"
#include "earshot/bvh/builder_names.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include "support/moving_meshes.h"
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;
using support::Dice;

/// A square of cloth, crumpled: every vertex is somewhere near its place, and moves.
MovingMesh cloth(int side, double crumple, double height, Dice& dice) {
    MovingMesh mesh;
    const auto shaken = [&](const Vec3& p) {
        return p + crumple * Vec3(dice.between(-1.0, 1.0),
                                  dice.between(-1.0, 1.0),
                                  dice.between(-1.0, 1.0));
    };
    for (int i = 0; i <= side; ++i) {
        for (int k = 0; k <= side; ++k) {
            const Vec3 place(i / double(side), height, k / double(side));
            mesh.begin.push_back(shaken(place));
            mesh.end.push_back(shaken(place));
        }
    }
    for (int i = 0; i < side; ++i) {
        for (int k = 0; k < side; ++k) {
            const auto corner = static_cast<VertexId>(i * (side + 1) + k);
            const auto next = corner + static_cast<VertexId>(side) + 1;
            mesh.triangles.push_back({corner, next, next + 1});
            mesh.triangles.push_back({corner, next + 1, corner + 1});
        }
    }
    return mesh;
}

TEST(World, FindsWhatAllPairsOfElementsFind) {
    Dice dice(1);
    for (const double crumple : {0.02, 0.1, 0.3}) {
        std::vector<MovingMesh> meshes{cloth(7, crumple, 0.0, dice), cloth(5, crumple, 0.05, dice)};
        // A triangle that stands twice, and one without area.
        meshes[0].triangles.push_back(meshes[0].triangles[3]);
        meshes[0].triangles.push_back({4, 4, 9});
        for (const auto& [between, within] :
             {std::pair(true, false), {false, true}, {true, true}}) {
            World world = world_of(meshes);
            const auto contacts =
                world.contacts({.between_meshes = between, .within_meshes = within});
            std::set<Found> set;
            for (const Contact& contact : contacts) {
                EXPECT_TRUE(set.insert(found(contact)).second);
            }
            EXPECT_EQ(set, brute_force(meshes, between, within)) << crumple;
            EXPECT_TRUE(std::is_sorted(contacts.begin(), contacts.end()));
        }
    }
}

TEST(World, DoesNotDependOnThreadsAndStepsBefore) {
    Dice dice(2);
    std::vector<MovingMesh> meshes{cloth(12, 0.1, 0.0, dice), cloth(12, 0.1, 0.1, dice)};
    World long_lived = world_of(meshes);
    const ContactOptions options{.within_meshes = true};
    for (int step = 0; step < 6; ++step) {
        for (std::uint32_t m = 0; m < 2; ++m) {
            meshes[m].begin = meshes[m].end;
            meshes[m].end = cloth(12, 0.05 + 0.05 * step, 0.1 * m, dice).end;
            long_lived.update(m, meshes[m].begin, meshes[m].end);
        }
        Executor executor(1 + step);
        const auto contacts = long_lived.contacts(options, executor);
        World fresh = world_of(meshes);
        const auto expected = fresh.contacts(options);
        ASSERT_EQ(contacts.size(), expected.size());
        ASSERT_FALSE(contacts.empty());
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            ASSERT_EQ(found(contacts[i]), found(expected[i]));
            ASSERT_EQ(contacts[i].point, expected[i].point);
            ASSERT_EQ(contacts[i].normal, expected[i].normal);
        }
    }
}

/// All of two contacts that a file would show.
bool are_same(const Contact& a, const Contact& b) {
    return found(a) == found(b) && a.point == b.point && a.normal == b.normal;
}

TEST(World, DoesNotDependOnBuilderThreadsOrInstructions) {
    // One world per builder lives through three steps: built, refitted, and with cloth so crumpled
    // that its tree is built anew.
    Dice dice(4);
    std::vector<MovingMesh> meshes{cloth(9, 0.02, 0.0, dice), cloth(9, 0.02, 0.03, dice)};
    std::vector<World> worlds;
    for (const bvh::NamedBuilder& named : bvh::named_builders()) {
        World& world = worlds.emplace_back(named.builder);
        for (const MovingMesh& mesh : meshes) {
            world.add_mesh(mesh.triangles, mesh.begin.size());
        }
    }
    for (const double crumple : {0.05, 0.06, 0.3}) {
        for (MovingMesh& mesh : meshes) {
            mesh.begin = mesh.end;
            mesh.end = cloth(9, crumple, 0.01, dice).end;
        }
        const auto expected = world_of(meshes).contacts({.within_meshes = true});
        ASSERT_GT(expected.size(), 100U);
        for (std::size_t i = 0; i < worlds.size(); ++i) {
            for (std::uint32_t m = 0; m < meshes.size(); ++m) {
                worlds[i].update(m, meshes[m].begin, meshes[m].end);
            }
            const auto expect_same = [&](int threads, const std::string& target) {
                override_simd_target(target);
                Executor executor(threads);
                const auto contacts = worlds[i].contacts({.within_meshes = true}, executor);
                EXPECT_TRUE(std::equal(
                    contacts.begin(), contacts.end(), expected.begin(), expected.end(), are_same))
                    << bvh::named_builders()[i].name << ", " << target << ", " << threads;
            };
            for (const int threads : {1, 2, 8}) {
                expect_same(threads, "auto");
            }
            for (const std::string& target : simd_targets()) {
                expect_same(2, target);
            }
            override_simd_target("auto");
        }
    }
}

/// A triangle that falls onto a floor of two.
std::vector<MovingMesh> falling_triangle() {
    MovingMesh floor{{{0, 1, 2}, {0, 2, 3}}, {{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}}, {}};
    floor.end = floor.begin;
    MovingMesh triangle{{{0, 1, 2}}, {{0.5, 1, 2}, {1.5, 2, 2.5}, {0.5, 2, 3}}, {}};
    triangle.end = triangle.begin;
    for (Vec3& point : triangle.end) {
        point.y -= 1.5;
    }
    return {floor, triangle};
}

TEST(World, SaysWhenAndWhereAndFromWhere) {
    World world = world_of(falling_triangle());
    const auto first = world.first_contact();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->kind, ContactKind::vertex_face);
    EXPECT_EQ(first->a, element(1, {0}));
    EXPECT_EQ(first->b, element(0, {0, 1, 2}));
    EXPECT_LE(first->toi, 2.0 / 3.0);
    EXPECT_NEAR(first->toi, 2.0 / 3.0, 1e-11);
    EXPECT_NEAR(first->normal.y, 1.0, 1e-12);
    EXPECT_NEAR(first->point.x, 0.5, 1e-12);
    EXPECT_NEAR(first->point.y, 0.0, 1e-10);
    EXPECT_FALSE(world.first_contact({.between_meshes = false, .within_meshes = true}));
    EXPECT_FALSE(
        world.first_contact({.filter = [](std::uint32_t, std::uint32_t) { return false; }}));
    const auto near = world.first_contact({.min_separation = 0.15, .tolerance = 1e-3});
    ASSERT_TRUE(near);
    EXPECT_LE(near->toi, 0.85 / 1.5);
    EXPECT_GT(near->toi, 0.8 / 1.5);
}

TEST(World, SaysWhatMeetsAtTheBeginning) {
    auto meshes = falling_triangle();
    EXPECT_TRUE(world_of(meshes).contacts_at_begin().empty());
    for (Vec3& point : meshes[1].begin) {
        point.y -= 1.5;
    }
    const auto contacts = world_of(meshes).contacts_at_begin();
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts[0].kind, ContactKind::triangle_triangle);
    EXPECT_EQ(contacts[0].a, element(0, {0, 1, 2}));
    EXPECT_EQ(contacts[0].b, element(1, {0, 1, 2}));
    EXPECT_NEAR(contacts[0].point.y, 0.0, 1e-12);
}

TEST(World, SaysHowFarApartMeshesAreAtTheBeginning) {
    auto meshes = falling_triangle();
    World world = world_of(meshes);
    EXPECT_EQ(world.distance_at_begin(0, 1).distance, 1.0);
    EXPECT_EQ(world.distance_at_begin(0, 0).distance, 0.0);
    world.update(1, meshes[1].end, meshes[1].end);
    EXPECT_EQ(world.distance_at_begin(1, 0).distance, 0.0);
    std::swap(meshes[1].begin, meshes[1].end);
    EXPECT_EQ(world_of(meshes).contacts_at_begin().size(), world.contacts_at_begin().size());
    world.update(1, meshes[1].end, meshes[1].end);
    EXPECT_EQ(world.distance_at_begin(1, 0).distance, 1.0);
}

TEST(World, RefusesWhatIsNoMeshAndIsEmptyWithoutOne) {
    World world;
    EXPECT_TRUE(world.contacts().empty());
    const std::vector<Triangle> triangles{{0, 1, 7}};
    EXPECT_THROW(world.add_mesh(triangles, 3), Error);
    const std::uint32_t mesh = world.add_mesh({}, 1);
    const std::vector<Vec3> nowhere{Vec3(NAN)};
    EXPECT_THROW(world.update(mesh, nowhere, nowhere), Error);
    EXPECT_TRUE(world.contacts().empty());
}

}  // namespace
}  // namespace earshot::collision
