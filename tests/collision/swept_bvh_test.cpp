// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/swept_bvh.h"

#include "earshot/bvh/builder_names.h"

#include <gtest/gtest.h>

#include "support/dice.h"
#include <algorithm>
#include <vector>

namespace earshot::collision {
namespace {

using geometry::Triangle;
using geometry::Vec3;
using support::Dice;

/// Triangles anywhere, that fly apart as time goes on.
void place(MovingScene& scene, double time) {
    Dice dice(2);
    const auto point = [&] {
        return Vec3(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1));
    };
    for (std::uint32_t mesh = 0; mesh < scene.meshes(); ++mesh) {
        std::vector<Vec3> begin, end;
        while (begin.size() < scene.first_vertex[mesh + 1] - scene.first_vertex[mesh]) {
            const Vec3 middle = 3.0 * point() + 4.0 * time * point();
            for (std::size_t k = 0; k < 3; ++k) {
                begin.push_back(middle + 0.1 * point());
                end.push_back(begin.back() + 0.1 * point());
            }
        }
        scene.move(mesh, begin, end);
    }
}

/// Expects of every node that its slots are those of the leaves below it.
void expect_slots_below(const SweptBvh& bvh) {
    const auto nodes = bvh.tree().nodes();
    std::vector<std::vector<std::uint32_t>> below(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) {
        if (nodes[i].is_leaf()) {
            for (std::uint32_t slot = nodes[i].first; slot < nodes[i].first + nodes[i].count;
                 ++slot) {
                below[i].push_back(slot);
            }
        } else {
            for (const std::uint32_t child : {nodes[i].first, nodes[i].first + 1}) {
                below[i].insert(below[i].end(), below[child].begin(), below[child].end());
            }
        }
        std::sort(below[i].begin(), below[i].end());
        const SlotRange slots = bvh.slots_of_node(static_cast<std::uint32_t>(i));
        ASSERT_EQ(slots.begin, below[i].front());
        ASSERT_EQ(slots.end, below[i].back() + 1);
        ASSERT_EQ(slots.end - slots.begin, below[i].size());
    }
}

TEST(SweptBvh, KnowsTheSlotsOfEveryNodeAfterEveryUpdate) {
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i < 400; ++i) {
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    for (const bvh::NamedBuilder& named : bvh::named_builders()) {
        MovingScene scene;
        scene.add(triangles, 1200);
        scene.add(std::span(triangles).first(3), 9);
        SweptBvh bvh(named.builder);
        std::size_t changes = 0;
        for (int step = 0; step < 12; ++step) {
            place(scene, 0.2 * step);
            changes += bvh.update(scene, 0.0, Executor::serial()) ? 1 : 0;
            EXPECT_EQ(bvh.last_action().has_value(), step > 0);
            expect_slots_below(bvh);
            bvh.expect_box_tests(40000);
        }
        EXPECT_GT(changes, 1U) << named.name;
    }
}

}  // namespace
}  // namespace earshot::collision
