// SPDX-License-Identifier: MIT
// The comparison counts what it says: known paths are dropped, repeated, shifted and misnamed.
#include "support/compare_paths.h"

#include <gtest/gtest.h>

#include "support/rooms.h"
#include <array>
#include <vector>

namespace earshot::support {
namespace {

using geometry::Vec3;

class ComparePaths : public testing::Test {
protected:
    // The oracle's own answer, with the first triangle that carries each wall's label and holds
    // the reflection point found by trying both.
    ComparePaths() {
        for (const OraclePath& path : oracle.paths) {
            frustum::SpecularPath one{.listener = path.listener,
                                      .triangles = {},
                                      .points = path.points,
                                      .length = path.length};
            for (const std::uint32_t label : path.labels) {
                one.triangles.push_back(2 * label);
            }
            for (std::size_t i = 0; i < one.triangles.size(); ++i) {
                const auto misnamed = [&] {
                    return compare_paths(std::array{one}, oracle, room.mesh).misnamed;
                };
                for (std::size_t j = 0; j <= i && misnamed() > 0; ++j) {
                    one.triangles[j] ^= 1U;
                }
            }
            traced.push_back(one);
        }
    }

    Room room = box_room(Vec3{0.0}, {5.0, 3.0, 4.0});
    std::array<Vec3, 2> listeners = {Vec3{1.0, 1.2, 3.1}, Vec3{4.1, 1.3, 0.9}};
    OracleResult oracle = search_image_sources(
        room.mesh.view(), room.labels, {2.2, 1.7, 1.9}, listeners, {.max_order = 1});
    std::vector<frustum::SpecularPath> traced{};
};

TEST_F(ComparePaths, FindsNoDifferenceWhereThereIsNone) {
    const Comparison same = compare_paths(traced, oracle, room.mesh);
    EXPECT_EQ(same.expected, 14U);
    EXPECT_EQ(same.found, 14U);
    EXPECT_EQ(same.missed + same.false_paths + same.doubled + same.misnamed, 0U) << same.details;
}

TEST_F(ComparePaths, CountsMissedPaths) {
    traced.erase(traced.begin() + 3);
    const Comparison less = compare_paths(traced, oracle, room.mesh);
    EXPECT_EQ(less.missed, 1U);
    EXPECT_EQ(less.false_paths + less.doubled + less.misnamed, 0U);
    EXPECT_NE(less.details.find("missed"), std::string::npos);
}

TEST_F(ComparePaths, CountsDoubledPaths) {
    traced.push_back(traced[3]);
    const Comparison more = compare_paths(traced, oracle, room.mesh);
    EXPECT_EQ(more.doubled, 1U);
    EXPECT_EQ(more.missed + more.false_paths + more.misnamed, 0U);
}

TEST_F(ComparePaths, CountsFalsePaths) {
    traced[3].listener = 1 - traced[3].listener;
    const Comparison other = compare_paths(traced, oracle, room.mesh);
    EXPECT_EQ(other.false_paths, 1U);
    EXPECT_EQ(other.missed, 1U);
}

TEST_F(ComparePaths, CountsLengthsThatAreALittleOff) {
    traced[3].length += 1e-8;
    const Comparison off = compare_paths(traced, oracle, room.mesh);
    EXPECT_EQ(off.false_paths, 1U);
    EXPECT_EQ(off.missed, 1U);
}

TEST_F(ComparePaths, CountsTrianglesWithoutTheReflectionPoint) {
    const Comparison before = compare_paths(traced, oracle, room.mesh);
    ASSERT_EQ(traced[3].triangles.size(), 1U);
    traced[3].triangles[0] = (traced[3].triangles[0] + 2) % 12;
    const Comparison after = compare_paths(traced, oracle, room.mesh);
    EXPECT_EQ(before.misnamed, 0U);
    EXPECT_EQ(after.misnamed, 1U);
    EXPECT_EQ(after.missed + after.false_paths + after.doubled, 0U);
}

TEST_F(ComparePaths, LetsAmbiguousPathsBeReportedOnceOrNotAtAll) {
    oracle.ambiguous.push_back(oracle.paths[3]);
    oracle.paths.erase(oracle.paths.begin() + 3);
    EXPECT_EQ(compare_paths(traced, oracle, room.mesh).false_paths, 0U);
    traced.push_back(traced[3]);
    EXPECT_EQ(compare_paths(traced, oracle, room.mesh).doubled, 1U);
    traced.pop_back();
    traced.erase(traced.begin() + 3);
    EXPECT_EQ(compare_paths(traced, oracle, room.mesh).missed, 0U);
}

}  // namespace
}  // namespace earshot::support
