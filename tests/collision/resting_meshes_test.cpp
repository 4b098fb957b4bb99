// SPDX-License-Identifier: MIT
//
// Worlds in which some meshes rest while others move: what is kept of those changes no contact.

#include "earshot/collision/world.h"

#include <gtest/gtest.h>

#include "support/collision_sequences.h"
#include "support/dice.h"
#include <algorithm>
#include <tuple>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::Vec3;
using support::Dice;
using support::Part;

auto as_tuple(const Contact& c) {
    return std::tuple(c.kind,
                      c.a,
                      c.b,
                      c.toi,
                      c.point.x,
                      c.point.y,
                      c.point.z,
                      c.normal.x,
                      c.normal.y,
                      c.normal.z);
}

void expect_same(const std::vector<Contact>& found, const std::vector<Contact>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_TRUE(as_tuple(found[i]) == as_tuple(expected[i])) << i;
    }
}

World world_of(const std::vector<Part>& parts) {
    World world;
    for (const Part& part : parts) {
        world.add_mesh(part.triangles, part.at(0.0).size());
    }
    return world;
}

/// The step of a mesh: between two times of its motion, or on a screw.
struct Step {
    double from = 0.0, to = 0.0;
    bool is_on_screw = false;
};

/// Meshes rest or move with these odds; far away ones take the middle of the scene with them.
Step next_step(const Step& last, Dice& dice) {
    if (dice.chance(0.6)) {
        return {last.to, last.to};
    }
    const double far = dice.chance(0.1) ? 6.0 : 1.0;
    return {last.to, far * dice.between(0.0, 1.0), dice.chance(0.15)};
}

void take(World& world, const std::vector<Part>& parts, std::uint32_t mesh, const Step& step) {
    if (step.is_on_screw) {
        world.update(mesh, parts[mesh].at(step.from), Screw{.angle = 0.3 * step.to});
    } else {
        world.update(mesh, parts[mesh].at(step.from), parts[mesh].at(step.to));
    }
}

TEST(RestingMeshes, ContactsAreThoseOfANewWorld) {
    const std::vector<Part> parts = support::flying_balls(10, 8, 6);
    World kept = world_of(parts);
    Dice dice(7);
    std::vector<Step> steps(parts.size());
    std::size_t contacts = 0;
    for (int i = 0; i < 40; ++i) {
        World fresh = world_of(parts);
        for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
            steps[mesh] = next_step(steps[mesh], dice);
            take(kept, parts, mesh, steps[mesh]);
            take(fresh, parts, mesh, steps[mesh]);
            // A mesh on a screw ends elsewhere than the next step begins.
            steps[mesh].to = steps[mesh].is_on_screw ? steps[mesh].from : steps[mesh].to;
        }
        const ContactOptions options{.within_meshes = i % 3 == 0,
                                     .min_separation = i % 7 == 6 ? 0.01 : 0.0,
                                     .cull_with_normal_cones = i % 5 != 0};
        Executor executor(1 + i % 2);
        if (i % 4 != 3) {
            const auto found = kept.contacts(options, executor);
            expect_same(found, fresh.contacts(options));
            contacts += found.size();
        }
        if (i % 4 != 1) {
            const auto found = kept.contacts_at_begin(options, executor);
            expect_same(found, fresh.contacts_at_begin(options));
            contacts += found.size();
        }
    }
    EXPECT_GT(contacts, 1000U);
}

TEST(RestingMeshes, OneThatIsTakenOutOrAddedMovesTheOthersInMemoryOnly) {
    std::vector<Part> parts = support::flying_balls(6, 8, 6);
    World kept = world_of(parts);
    for (int i = 0; i < 4; ++i) {
        if (i == 2) {
            kept.remove_mesh(1);
        } else if (i == 3) {
            parts.push_back(support::flying_balls(7, 8, 6).back());
            kept.add_mesh(parts.back().triangles, parts.back().at(0.0).size());
        }
        World fresh = world_of(parts);
        for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
            const double time = mesh == 0 ? 0.1 * i : 0.4;
            if (mesh != 1 || i < 2) {
                take(kept, parts, mesh, {time, time + 0.1});
                take(fresh, parts, mesh, {time, time + 0.1});
            }
        }
        if (i >= 2) {
            fresh.remove_mesh(1);
        }
        const ContactOptions options{.within_meshes = true};
        expect_same(kept.contacts(options), fresh.contacts(options));
        expect_same(kept.contacts_at_begin(options), fresh.contacts_at_begin(options));
    }
}

TEST(RestingMeshes, TakeNoWorkAtAnInstant) {
    const std::vector<Part> parts = support::flying_balls(40, 16, 10);
    World world = world_of(parts);
    const auto work_with = [&](double time_of_first) {
        for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
            const double time = mesh == 0 ? time_of_first : 0.5;
            take(world, parts, mesh, {time, time});
        }
        EXPECT_FALSE(world.contacts_at_begin({.within_meshes = true}).empty());
        return world.statistics();
    };
    const WorldStatistics all = work_with(0.5);
    EXPECT_GT(all.elementary_tests, 100U);
    const WorldStatistics none = work_with(0.5);
    EXPECT_EQ(none.triangle_pairs, 0U);
    EXPECT_EQ(none.elementary_tests, 0U);
    EXPECT_EQ(none.updates, bvh::UpdateStatistics{});
    // The shape of the one that moves, and the upper tree.
    const WorldStatistics of_first = work_with(0.45);
    EXPECT_EQ(of_first.updates.refits + of_first.updates.repairs + of_first.updates.rebuilds, 2U);
    EXPECT_LT(3 * of_first.elementary_tests, all.elementary_tests);
}

}  // namespace
}  // namespace earshot::collision
