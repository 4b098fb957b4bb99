// SPDX-License-Identifier: MIT
// The oracle of the specular path tests is itself held against what it does not share: the closed
// form of the box, tables made elsewhere, and cases small enough to work out by hand.
#include <gtest/gtest.h>

#include "support/air.h"
#include "support/image_source_oracle.h"
#include "support/oracle_facets.h"
#include "support/path_facts.h"
#include "support/path_table.h"
#include "support/random_rooms.h"
#include "support/rooms.h"
#include "support/shoebox_images.h"
#include "truth/hand_cases.h"
#include "truth/reference_cases.h"
#include <array>
#include <string>
#include <vector>

namespace earshot::support {
namespace {

using geometry::Vec3;

OracleResult search(const Room& room, const Vec3& source, const Vec3& listener, int order) {
    const std::array listeners = {listener};
    return search_image_sources(
        room.mesh.view(), room.labels, source, listeners, {.max_order = order});
}

TEST(ShoeboxImages, CountsAreThoseOfTheLattice) {
    const auto images =
        shoebox_images(Vec3{0.0}, {5.0, 3.0, 4.0}, {1.0, 1.0, 1.0}, {2.0, 2.0, 2.0}, 4);
    std::array<int, 5> per_order{};
    for (const ShoeboxImage& image : images) {
        ++per_order.at(static_cast<std::size_t>(image.order));
    }
    EXPECT_EQ(per_order, (std::array{1, 6, 18, 38, 66}));
}

TEST(Oracle, FindsTheImagesOfABox) {
    const Vec3 lower{-1.0, 0.0, -2.5};
    const Vec3 upper{4.3, 2.7, 3.1};
    for (const Room& room : {box_room(lower, upper), tessellated_box_room(lower, upper, 5)}) {
        Dice dice(7);
        for (int i = 0; i < 3; ++i) {
            const Vec3 source = random_air_point(room, dice);
            const Vec3 listener = random_air_point(room, dice);
            const OracleResult result = search(room, source, listener, 4);
            EXPECT_EQ(result.paths.size(), 129U) << room.kind;
            EXPECT_EQ(result.ambiguous.size(), 0U);
            EXPECT_EQ(disagreement(facts_of(result.paths),
                                   shoebox_images(lower, upper, source, listener, 4),
                                   1e-13),
                      "")
                << room.kind;
        }
    }
}

class OracleTables : public testing::TestWithParam<ReferenceCase> {};

TEST_P(OracleTables, MatchEveryLine) {
    const ReferenceCase& test = GetParam();
    const OracleResult result = search(test.room(), test.source, test.listener, test.max_order);
    EXPECT_EQ(disagreement(facts_of(result.paths), read_path_table(test.table), 1e-12), "");
    EXPECT_EQ(result.ambiguous.size(), test.ambiguous);
}

INSTANTIATE_TEST_SUITE_P(Reference,
                         OracleTables,
                         testing::ValuesIn(reference_cases()),
                         [](const auto& test) { return test.param.name; });

std::vector<std::size_t> count_per_order(const std::vector<OraclePath>& paths, std::size_t orders) {
    std::vector<std::size_t> counts(orders);
    for (const OraclePath& path : paths) {
        ++counts.at(path.labels.size());
    }
    return counts;
}

OracleResult search(const HandCase& test) {
    const std::array listeners = {test.listener};
    const int max_order = static_cast<int>(test.paths_per_order.size()) - 1;
    return search_image_sources(
        test.room.mesh.view(),
        test.room.labels,
        test.source,
        listeners,
        {.max_order = max_order, .one_sided_labels = test.one_sided_labels});
}

class OracleClearCases : public testing::TestWithParam<HandCase> {};

TEST_P(OracleClearCases, MatchByHand) {
    const OracleResult result = search(GetParam());
    const auto& expected = GetParam().paths_per_order;
    EXPECT_EQ(count_per_order(result.paths, expected.size()), expected);
    EXPECT_TRUE(result.ambiguous.empty());
}

INSTANTIATE_TEST_SUITE_P(Hand,
                         OracleClearCases,
                         testing::ValuesIn(clear_cases()),
                         [](const auto& test) { return test.param.name; });

class OracleDegenerateCases : public testing::TestWithParam<HandCase> {};

TEST_P(OracleDegenerateCases, AreAmbiguousWithinBounds) {
    const OracleResult result = search(GetParam());
    const auto& expected = GetParam().paths_per_order;
    const auto certain = count_per_order(result.paths, expected.size());
    const auto ambiguous = count_per_order(result.ambiguous, expected.size());
    for (std::size_t order = 0; order < expected.size(); ++order) {
        EXPECT_LE(certain[order], expected[order]) << "order " << order;
        EXPECT_GE(certain[order] + ambiguous[order], expected[order]) << "order " << order;
    }
}

INSTANTIATE_TEST_SUITE_P(Hand,
                         OracleDegenerateCases,
                         testing::ValuesIn(degenerate_cases()),
                         [](const auto& test) { return test.param.name; });

TEST(Oracle, MarginIsTheDistanceToTheNearestTurn) {
    // The direct sound passes a screen's upper edge (y = 2) a tenth of a millimetre above it; the
    // floor's reflection point lies 0.25 m from the screen's foot and runs through the screen.
    Room room = box_room(Vec3{0.0}, {10.0, 4.0, 6.0});
    const std::array<Vec3, 4> screen = {
        Vec3{5.0, 1.0, 1.0}, Vec3{5.0, 2.0, 1.0}, Vec3{5.0, 2.0, 5.0}, Vec3{5.0, 1.0, 5.0}};
    add_polygon(room, screen, 6, true);
    const OracleResult above = search(room, {2.0, 2.0001, 3.0}, {8.0, 2.0001, 3.0}, 0);
    ASSERT_EQ(above.paths.size(), 1U);
    EXPECT_NEAR(above.paths[0].margin, 1e-4, 1e-12);
    for (const double shift : {-1e-10, 0.0, 1e-10}) {
        const OracleResult at = search(room, {2.0, 2.0 + shift, 3.0}, {8.0, 2.0 + shift, 3.0}, 0);
        ASSERT_EQ(at.ambiguous.size(), 1U) << shift;
        EXPECT_TRUE(at.paths.empty());
        EXPECT_NEAR(at.ambiguous[0].margin, shift, 1e-13);
    }
    const OracleResult below = search(room, {2.0, 1.9999, 3.0}, {8.0, 1.9999, 3.0}, 0);
    EXPECT_TRUE(below.paths.empty());
    EXPECT_TRUE(below.ambiguous.empty());
}

// Pruning may only leave out what cannot be a path, wherever decisions are close.
TEST(Oracle, PruningLosesNothing) {
    for (std::uint64_t seed = 0; seed < 3 * kRoomFamilies; ++seed) {
        const Room room = random_room(seed);
        if (room.mesh.triangles.size() > 40) {
            continue;
        }
        Dice dice(seed + 2000);
        const Vec3 source = random_air_point(room, dice);
        std::vector<Vec3> listeners;
        for (int i = 0; i < 4; ++i) {
            listeners.push_back(aimed_air_point(room, source, dice));
        }
        OracleOptions options{.max_order = 3};
        const OracleResult pruned =
            search_image_sources(room.mesh.view(), room.labels, source, listeners, options);
        options.prunes = false;
        const OracleResult whole =
            search_image_sources(room.mesh.view(), room.labels, source, listeners, options);
        ASSERT_EQ(pruned.paths.size(), whole.paths.size()) << "seed " << seed;
        EXPECT_EQ(pruned.ambiguous.size(), whole.ambiguous.size()) << "seed " << seed;
        for (std::size_t i = 0; i < whole.paths.size(); ++i) {
            EXPECT_EQ(pruned.paths[i].points, whole.paths[i].points) << "seed " << seed;
        }
    }
}

// Source and listener are treated quite differently; their paths are the same.
TEST(Oracle, FindsTheSamePathsBackwards) {
    for (std::uint64_t seed = 0; seed < 2 * kRoomFamilies; ++seed) {
        const Room room = random_room(seed);
        Dice dice(seed + 1000);
        const Vec3 source = random_air_point(room, dice);
        const Vec3 listener = random_air_point(room, dice);
        const OracleResult there = search(room, source, listener, 2);
        const OracleResult back = search(room, listener, source, 2);
        ASSERT_EQ(there.paths.size(), back.paths.size()) << "seed " << seed << ", " << room.kind;
        for (std::size_t i = 0; i < there.paths.size(); ++i) {
            EXPECT_NEAR(there.paths[i].length, back.paths[i].length, 1e-10)
                << "seed " << seed << ", " << room.kind;
        }
    }
}

}  // namespace
}  // namespace earshot::support
