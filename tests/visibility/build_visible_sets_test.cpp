// SPDX-License-Identifier: MIT
#include "earshot/visibility/build_visible_sets.h"

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace earshot::visibility {
namespace {

/// Two closed boxes of 3 m side by side, 1 m apart: 12 triangles each.
geometry::Mesh two_rooms() {
    geometry::Mesh mesh;
    for (const double x : {0.0, 4.0}) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (unsigned corner = 0; corner < 8; ++corner) {
            mesh.positions.emplace_back(
                x + 3.0 * (corner & 1U), 3.0 * (corner >> 1U & 1U), 3.0 * (corner >> 2U));
        }
        for (const auto& [a, b, c, d] : {std::array{0U, 1U, 3U, 2U},
                                         {4U, 5U, 7U, 6U},
                                         {0U, 1U, 5U, 4U},
                                         {2U, 3U, 7U, 6U},
                                         {0U, 2U, 6U, 4U},
                                         {1U, 3U, 7U, 5U}}) {
            mesh.triangles.push_back({first + a, first + b, first + c});
            mesh.triangles.push_back({first + a, first + c, first + d});
        }
    }
    return mesh;
}

class BuildVisibleSets : public testing::Test {
protected:
    VisibleSets build(const ViewRegion& region, const VisibleSetsOptions& options) {
        return build_visible_sets(tree_.view(), region, options, {.scene = "rooms", .seed = 7});
    }

    const geometry::Mesh mesh_ = two_rooms();
    const bvh::DeformableBvh tree_{mesh_.view()};
    const ViewRegion left_{{1, 1, 1}, {2, 2, 2}};
    const ViewRegion both_{{0.5, 0.5, 0.5}, {6.5, 2.5, 2.5}};
};

TEST_F(BuildVisibleSets, OneCellSeesItsRoomAndNothingElse) {
    const VisibleSets sets = build(left_, {.max_rays = 20000, .validation_rays = 1000});
    ASSERT_EQ(sets.cells().size(), 1U);
    EXPECT_FALSE(sets.history());
    std::vector<geometry::TriangleId> expected(12);
    for (std::uint32_t i = 0; i < 12; ++i) {
        expected[i] = i;
    }
    EXPECT_EQ(sets.triangles_visible_from(0), expected);
    EXPECT_EQ(sets.provenance().scene, "rooms");
    EXPECT_EQ(sets.provenance().seed, 7U);
    EXPECT_GT(sets.provenance().rays, 0U);
    // Whoever stands in the left room sees that room in all directions.
    ASSERT_TRUE(sets.provenance().validation);
    EXPECT_EQ(sets.provenance().validation->rays, 1000U);
    EXPECT_EQ(sets.provenance().validation->missed, 0U);
}

TEST_F(BuildVisibleSets, TheCellsOfAGridSeeTheirRooms) {
    const VisibleSets sets =
        build(both_, {.grid = {{6, 1, 1}}, .max_rays = 400000, .validation_rays = 0});
    ASSERT_EQ(sets.cells().size(), 6U);
    ASSERT_TRUE(sets.history());
    EXPECT_FALSE(sets.provenance().validation);
    const auto last = [&](const geometry::Vec3& point) {
        return sets.triangles_visible_from(*sets.cells().cell_at(point)).back();
    };
    const auto first = [&](const geometry::Vec3& point) {
        return sets.triangles_visible_from(*sets.cells().cell_at(point)).front();
    };
    EXPECT_LT(last({1, 1, 1}), 12U);
    EXPECT_GE(first({6, 1, 1}), 12U);
}

TEST_F(BuildVisibleSets, CellsAreDividedAsAsked) {
    const VisibleSets sets =
        build(both_, {.max_cells = 5, .triangles_per_object = 4, .max_rays = 50000});
    // No more, and no cell that nothing is saved by.
    EXPECT_GT(sets.cells().size(), 1U);
    EXPECT_LE(sets.cells().size(), 5U);
    EXPECT_LT(sets.objects().size(), 24U);
    // A tenth of the rays would be less than is needed for a bound that says anything.
    EXPECT_EQ(sets.provenance().validation->rays, 65536U);
}

TEST_F(BuildVisibleSets, StagesAreReportedInTurn) {
    class Stages : public Progress {
    public:
        void report(std::string_view stage, std::size_t, std::size_t) override {
            if (seen.empty() || seen.back() != stage) {
                seen.emplace_back(stage);
            }
        }
        std::vector<std::string> seen;
    } stages;
    build(both_, {.max_cells = 3, .max_rays = 1000, .validation_rays = 10, .progress = &stages});
    EXPECT_EQ(stages.seen, (std::vector<std::string>{"view cells", "rays", "validation rays"}));
}

TEST_F(BuildVisibleSets, AnInterruptEndsTheSampling) {
    const VisibleSets sets = build(left_, {.validation_rays = 0, .interrupt = [] { return true; }});
    EXPECT_LT(sets.provenance().rays, 10'000'000U);
}

TEST(RegionOf, IsTheBoxOrAPoint) {
    geometry::Aabb box;
    EXPECT_EQ(region_of(box), (ViewRegion{}));
    box.lower = {0.0F, 1.0F, 2.0F};
    box.upper = {3.0F, 4.0F, 5.0F};
    EXPECT_EQ(region_of(box), (ViewRegion{{0, 1, 2}, {3, 4, 5}}));
}

}  // namespace
}  // namespace earshot::visibility
