// SPDX-License-Identifier: MIT
#include "earshot/visibility/coherent_sight.h"

#include <gtest/gtest.h>

#include "sight_scenes.h"
#include "support/test_paths.h"
#include <algorithm>
#include <iostream>

namespace earshot::visibility {
namespace {

using geometry::Segment;
using geometry::Vec3;
using support::Dice;

Vec3 somewhere(Dice& dice) {
    return {dice.between(-2.0, 14.0), dice.between(0.0, 4.0), dice.between(-2.0, 14.0)};
}

/// A scene of the project, read once, at its instants.
class Moving {
public:
    explicit Moving(const std::string& name)
        : scene_(io::load_scene(test::source_file("scenes/" + name + ".gltf")).scene) {}

    geometry::MeshView at(double time) {
        positions_ = scene_.mesh.positions_at(time);
        return {positions_, scene_.mesh.triangles()};
    }

private:
    propagation::Scene scene_;
    std::vector<Vec3> positions_;
};

TEST(CoherentSight, AnswersAsIfItRememberedNothing) {
    Executor two(2);
    for (const std::string name : {"curtain", "door"}) {
        Moving scene(name);
        Dice dice(7);
        std::vector<Segment> segments(3000);
        for (Segment& segment : segments) {
            segment = {somewhere(dice), somewhere(dice)};
        }
        CoherentSight coherent(scene.at(0.0));
        Ignored ignored;
        ignored.add(2);
        CoherentSight with_ignored(scene.at(0.0), ignored);
        CoherentSight counted(scene.at(0.0));
        counted.count_work(true);
        for (int frame = 0; frame < 40; ++frame) {
            // The animation runs, halts, and jumps back; points move, and their number changes.
            const auto mesh = scene.at(frame < 30 ? 0.05 * std::max(0, frame - 5) : 0.3);
            for (int i = 0; i < (frame % 3) * 20; ++i) {
                segments[static_cast<std::size_t>(dice.below(static_cast<int>(segments.size())))]
                    .to = somewhere(dice);
            }
            if (frame == 20) {
                segments.resize(2500);
            }
            const auto tree = wide_tree_of(mesh);
            ASSERT_EQ(coherent.sees(mesh, segments, two), sees(tree, mesh, segments)) << frame;
            ASSERT_EQ(counted.sees(mesh, segments), sees(tree, mesh, segments)) << frame;
            ASSERT_EQ(with_ignored.sees(mesh, segments), sees(tree, mesh, segments, ignored));
        }
    }
}

TEST(CoherentSight, AnswersMatricesOfAnyShape) {
    Moving scene("curtain");
    Dice dice(8);
    std::vector<Vec3> from(20), to(30);
    CoherentSight coherent(scene.at(0.0));
    for (int frame = 0; frame < 12; ++frame) {
        const auto mesh = scene.at(0.1 * frame);
        if (frame == 0 || frame == 6) {
            from.resize(frame == 0 ? 20 : 30);
            to.resize(frame == 0 ? 30 : 20);
            std::generate(from.begin(), from.end(), [&] { return somewhere(dice); });
            std::generate(to.begin(), to.end(), [&] { return somewhere(dice); });
        }
        from[3] = somewhere(dice);
        const std::vector<std::uint8_t> kept = coherent.matrix(mesh, {from, to});
        const auto tree = wide_tree_of(mesh);
        std::size_t row = 0;
        sight_matrix(tree,
                     mesh,
                     {from, to},
                     {},
                     Executor::serial(),
                     [&](std::span<const std::uint8_t> seen) {
                         const auto begin = kept.begin() + static_cast<long>(row++ * to.size());
                         EXPECT_TRUE(std::equal(seen.begin(), seen.end(), begin));
                     });
        if (frame == 9) {
            coherent.sees(mesh, std::vector<Segment>(600));
        }
    }
}

TEST(CoherentSight, LooksIntoAThirdOfTheNodesAtMost) {
    for (const std::string name : {"curtain", "door"}) {
        Moving scene(name);
        Dice dice(9);
        std::vector<Segment> segments(5000);
        for (Segment& segment : segments) {
            segment = {somewhere(dice), somewhere(dice)};
        }
        CoherentSight coherent(scene.at(0.0));
        coherent.count_work(true);
        coherent.sees(scene.at(0.0), segments);
        std::uint64_t nodes = 0, from_scratch = 0;
        for (int frame = 1; frame <= 30; ++frame) {
            const auto mesh = scene.at(frame / 30.0);
            coherent.sees(mesh, segments);
            nodes += coherent.counts().nodes;
            CoherentSight fresh(mesh);
            fresh.count_work(true);
            fresh.sees(mesh, segments);
            from_scratch += fresh.counts().nodes;
            EXPECT_EQ(fresh.counts().kept, 0U);
        }
        std::cout << name << ": " << nodes << " nodes instead of " << from_scratch << ", 1/"
                  << static_cast<double>(from_scratch) / static_cast<double>(nodes) << "\n";
        EXPECT_LE(3 * nodes, from_scratch) << name;
    }
}

TEST(CoherentSight, CountsTheSameForAnyExecutor) {
    Executor two(2);
    Moving scene("curtain");
    std::vector<Segment> segments(4000);
    Dice dice(10);
    for (Segment& segment : segments) {
        segment = {somewhere(dice), somewhere(dice)};
    }
    CoherentSight one(scene.at(0.0)), other(scene.at(0.0), {}, {}, two);
    one.count_work(true);
    other.count_work(true);
    for (const double time : {0.0, 0.1, 0.1}) {
        const auto mesh = scene.at(time);
        one.sees(mesh, segments);
        other.sees(mesh, segments, two);
        EXPECT_EQ(one.counts(), other.counts());
    }
    EXPECT_EQ(one.counts().kept, segments.size());
    EXPECT_EQ(one.counts().nodes, 0U);
}

}  // namespace
}  // namespace earshot::visibility
