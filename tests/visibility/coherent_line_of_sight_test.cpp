// SPDX-License-Identifier: MIT
#include "earshot/visibility/coherent_line_of_sight.h"

#include <gtest/gtest.h>

#include "line_of_sight_scenes.h"
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

TEST(CoherentLineOfSight, EqualsTheAnswersWithoutCoherence) {
    Executor two(2);
    for (const std::string name : {"curtain", "door"}) {
        Moving scene(name);
        Dice dice(7);
        std::vector<Segment> segments(3000);
        for (Segment& segment : segments) {
            segment = {somewhere(dice), somewhere(dice)};
        }
        CoherentLineOfSight coherent(scene.at(0.0));
        ExclusionMask excluded;
        excluded.add(2);
        CoherentLineOfSight with_excluded(scene.at(0.0), excluded);
        CoherentLineOfSight counted(scene.at(0.0));
        counted.collect_statistics(true);
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
            ASSERT_EQ(coherent.visible(mesh, segments, two), visible({tree, mesh}, segments))
                << frame;
            ASSERT_EQ(counted.visible(mesh, segments), visible({tree, mesh}, segments)) << frame;
            ASSERT_EQ(with_excluded.visible(mesh, segments),
                      visible({tree, mesh}, segments, excluded));
        }
    }
}

TEST(CoherentLineOfSight, AnswersMatricesOfAnyShape) {
    Moving scene("curtain");
    Dice dice(8);
    std::vector<Vec3> from(20), to(30);
    CoherentLineOfSight coherent(scene.at(0.0));
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
        visibility_matrix({tree, mesh},
                          {from, to},
                          {},
                          Executor::serial(),
                          [&](std::span<const std::uint8_t> seen) {
                              const auto begin =
                                  kept.begin() + static_cast<long>(row++ * to.size());
                              EXPECT_TRUE(std::equal(seen.begin(), seen.end(), begin));
                          });
        if (frame == 9) {
            coherent.visible(mesh, std::vector<Segment>(600));
        }
    }
}

TEST(CoherentLineOfSight, VisitsAThirdOfTheNodesAtMost) {
    for (const std::string name : {"curtain", "door"}) {
        Moving scene(name);
        Dice dice(9);
        std::vector<Segment> segments(5000);
        for (Segment& segment : segments) {
            segment = {somewhere(dice), somewhere(dice)};
        }
        CoherentLineOfSight coherent(scene.at(0.0));
        coherent.collect_statistics(true);
        coherent.visible(scene.at(0.0), segments);
        std::uint64_t nodes = 0, from_scratch = 0;
        for (int frame = 1; frame <= 30; ++frame) {
            const auto mesh = scene.at(frame / 30.0);
            coherent.visible(mesh, segments);
            nodes += coherent.statistics().nodes;
            CoherentLineOfSight fresh(mesh);
            fresh.collect_statistics(true);
            fresh.visible(mesh, segments);
            from_scratch += fresh.statistics().nodes;
            EXPECT_EQ(fresh.statistics().kept, 0U);
        }
        std::cout << name << ": " << nodes << " nodes instead of " << from_scratch << ", 1/"
                  << static_cast<double>(from_scratch) / static_cast<double>(nodes) << "\n";
        EXPECT_LE(3 * nodes, from_scratch) << name;
    }
}

TEST(CoherentLineOfSight, CountsTheSameForAnyExecutor) {
    Executor two(2);
    Moving scene("curtain");
    std::vector<Segment> segments(4000);
    Dice dice(10);
    for (Segment& segment : segments) {
        segment = {somewhere(dice), somewhere(dice)};
    }
    CoherentLineOfSight one(scene.at(0.0)), other(scene.at(0.0), {}, {}, two);
    one.collect_statistics(true);
    other.collect_statistics(true);
    for (const double time : {0.0, 0.1, 0.1}) {
        const auto mesh = scene.at(time);
        one.visible(mesh, segments);
        other.visible(mesh, segments, two);
        EXPECT_EQ(one.statistics(), other.statistics());
    }
    EXPECT_EQ(one.statistics().kept, segments.size());
    EXPECT_EQ(one.statistics().nodes, 0U);
}

}  // namespace
}  // namespace earshot::visibility
