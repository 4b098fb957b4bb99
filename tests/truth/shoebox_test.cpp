// SPDX-License-Identifier: MIT
// Specular paths in a box against the closed form of Allen and Berkley 1979.
#include <gtest/gtest.h>

#include "support/air.h"
#include "support/path_facts.h"
#include "support/rooms.h"
#include "support/shoebox_images.h"
#include "support/traced_room.h"
#include <array>
#include <utility>
#include <vector>

namespace earshot::support {
namespace {

using geometry::Vec3;

constexpr int kPairsPerBox = 20;
constexpr int kMaxOrder = 4;
constexpr int kDivisions = 16;  // 3,072 triangles
constexpr std::array<std::size_t, 5> kPathsPerOrder = {1, 6, 18, 38, 66};

// Closed form and tracer both work in double precision; mirroring four times costs a few units in
// the last place of coordinates some ten times the box.
constexpr double kRelativeTolerance = 1e-10;

struct Box {
    Vec3 lower{0.0};
    Vec3 upper{1.0};
};

// A living room, a corridor, a hall, a cube about the origin, a box with no round number.
const std::array<Box, 5> kBoxes = {{{{0.0, 0.0, 0.0}, {5.0, 2.6, 4.0}},
                                    {{0.0, 0.0, 0.0}, {20.0, 2.5, 1.6}},
                                    {{-15.0, 0.0, -22.5}, {15.0, 14.0, 22.5}},
                                    {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}},
                                    {{0.1, -0.7, 1.3}, {7.43, 2.31, 6.17}}}};

class Shoebox : public testing::TestWithParam<std::size_t> {
protected:
    const Box& box() const { return kBoxes.at(GetParam()); }

    // The pairs follow from the box's number, for both tests alike.
    std::vector<std::pair<Vec3, Vec3>> pairs() const {
        Dice dice(100 + GetParam());
        const Room room = box_room(box().lower, box().upper);
        std::vector<std::pair<Vec3, Vec3>> result;
        for (int i = 0; i < kPairsPerBox; ++i) {
            const Vec3 source = random_air_point(room, dice);
            result.emplace_back(source, random_air_point(room, dice));
        }
        return result;
    }
};

TEST_P(Shoebox, PathsAreTheImagesOfTheClosedForm) {
    const Room room = box_room(box().lower, box().upper);
    const TracedRoom traced(room);
    for (const auto& [source, listener] : pairs()) {
        const auto paths = traced.paths(source, listener, {.max_order = kMaxOrder});
        std::array<std::size_t, 5> counts{};
        for (const auto& path : paths) {
            ++counts.at(path.triangles.size());
        }
        EXPECT_EQ(counts, kPathsPerOrder);
        EXPECT_EQ(
            disagreement(facts_of(paths, room.labels),
                         shoebox_images(box().lower, box().upper, source, listener, kMaxOrder),
                         kRelativeTolerance),
            "")
            << "box " << GetParam() << ", source " << source.x << ", " << source.y << ", "
            << source.z;
    }
}

TEST_P(Shoebox, TessellationChangesTriangleNumbersOnly) {
    const Room coarse = box_room(box().lower, box().upper);
    const Room fine = tessellated_box_room(box().lower, box().upper, kDivisions);
    const TracedRoom traced_coarse(coarse);
    const TracedRoom traced_fine(fine);
    ASSERT_EQ(traced_fine.facets().facets.size(), 6U);
    for (const auto& [source, listener] : pairs()) {
        const auto expected = traced_coarse.paths(source, listener, {.max_order = kMaxOrder});
        const auto found = traced_fine.paths(source, listener, {.max_order = kMaxOrder});
        ASSERT_EQ(found.size(), expected.size());
        const auto expected_facts = facts_of(expected, coarse.labels);
        const auto found_facts = facts_of(found, fine.labels);
        for (std::size_t i = 0; i < found.size(); ++i) {
            // Equal to the last bit, and in the same order.
            EXPECT_EQ(found[i].points, expected[i].points);
            EXPECT_EQ(found[i].length, expected[i].length);
            EXPECT_EQ(found_facts[i].labels, expected_facts[i].labels);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Shoebox, testing::Range<std::size_t>(0, kBoxes.size()));

}  // namespace
}  // namespace earshot::support
