// SPDX-License-Identifier: MIT
#include "earshot/collision/world.h"

#include <gtest/gtest.h>

#include "support/collision_sequences.h"
#include "support/moving_meshes.h"
#include <array>
#include <set>
#include <vector>

namespace earshot::collision {
namespace {

std::set<Found> found(const std::vector<Contact>& contacts) {
    std::set<Found> result;
    for (const Contact& contact : contacts) {
        EXPECT_TRUE(result.insert(found(contact)).second);
    }
    return result;
}

/// With all that saves work, and with each of it turned off; one of them lives through all steps.
struct Variants {
    Variants() {
        options[1].track_front = false;
        options[2].cull_with_normal_cones = false;
        options[3].assign_representatives = false;
        for (ContactOptions& option : options) {
            option.within_meshes = true;
        }
    }
    std::array<World, 4> worlds;
    std::array<ContactOptions, 4> options;
};

std::size_t compare(const std::vector<support::Part>& parts, int frames) {
    Variants variants;
    for (World& world : variants.worlds) {
        for (const support::Part& part : parts) {
            world.add_mesh(part.triangles, part.at(0.0).size());
        }
    }
    std::size_t count = 0;
    for (int frame = 0; frame < frames; ++frame) {
        std::vector<MovingMesh> meshes;
        for (const support::Part& part : parts) {
            meshes.push_back(
                {part.triangles, part.at(frame / double(frames)), part.at((frame + 1.0) / frames)});
        }
        const std::set<Found> expected = brute_force(meshes, true, true);
        count += expected.size();
        for (std::size_t i = 0; i < variants.worlds.size(); ++i) {
            for (std::uint32_t m = 0; m < meshes.size(); ++m) {
                variants.worlds[i].update(m, meshes[m].begin, meshes[m].end);
            }
            Executor executor(1 << i);
            EXPECT_EQ(found(variants.worlds[i].contacts(variants.options[i], executor)), expected)
                << "variant " << i << ", frame " << frame;
        }
    }
    return count;
}

TEST(WorldSequences, ClothThatSlidesOverABall) {
    EXPECT_GT(compare(support::cloth_on_ball(24), 6), 10U);
}

TEST(WorldSequences, LayersOfASkirt) {
    // So coarse, and each so different, that layers that lie close cut each other.
    std::vector<support::Part> layers;
    for (int i = 0; i < 6; ++i) {
        layers.push_back(support::layer(i, 12 + i % 3, 3));
    }
    EXPECT_GT(compare(layers, 10), 10U);
}

TEST(WorldSequences, BallsThatFlyThroughEachOther) {
    EXPECT_GT(compare(support::flying_balls(16, 8, 5), 6), 10U);
}

}  // namespace
}  // namespace earshot::collision
