// SPDX-License-Identifier: MIT
// Specular paths in cases that can be worked out by hand (hand_cases.cpp says how).
#include "truth/hand_cases.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/traced_room.h"
#include <algorithm>
#include <array>
#include <vector>

namespace earshot::support {
namespace {

using frustum::Mode;

class HandCases : public testing::TestWithParam<HandCase> {
protected:
    std::vector<frustum::SpecularPath> trace(Mode mode) const {
        const HandCase& test = GetParam();
        const TracedRoom room(test.room.mesh, test.room.labels, test.one_sided_labels);
        const int max_order = static_cast<int>(test.paths_per_order.size()) - 1;
        return room.paths(test.source, test.listener, {.max_order = max_order, .mode = mode});
    }
};

TEST_P(HandCases, PathsPerOrder) {
    std::vector<std::size_t> counts(GetParam().paths_per_order.size());
    for (const auto& path : trace(Mode::complete)) {
        ++counts.at(path.triangles.size());
        EXPECT_EQ(path.points.size(), path.triangles.size() + 2);
        EXPECT_EQ(path.points.front(), GetParam().source);
        EXPECT_EQ(path.points.back(), GetParam().listener);
    }
    EXPECT_EQ(counts, GetParam().paths_per_order);
}

// Where two facets reflect one way through space, the sampled mode may have found the other.
TEST_P(HandCases, SampledModeFindsNothingElse) {
    const auto all = trace(Mode::complete);
    for (const auto& path : trace(Mode::sampled)) {
        const auto same_way = [&](const frustum::SpecularPath& other) {
            return std::equal(path.points.begin(),
                              path.points.end(),
                              other.points.begin(),
                              other.points.end(),
                              [](const geometry::Vec3& a, const geometry::Vec3& b) {
                                  return glm::distance(a, b) < 1e-12;
                              });
        };
        EXPECT_EQ(std::count_if(all.begin(), all.end(), same_way), 1) << "length " << path.length;
    }
}

INSTANTIATE_TEST_SUITE_P(Clear, HandCases, testing::ValuesIn(clear_cases()), [](const auto& test) {
    return test.param.name;
});
INSTANTIATE_TEST_SUITE_P(Degenerate,
                         HandCases,
                         testing::ValuesIn(degenerate_cases()),
                         [](const auto& test) { return test.param.name; });

TEST(DirectPath, BetweenCoincidentPointsHasLengthZero) {
    const TracedRoom room(box_room(geometry::Vec3{0.0}, geometry::Vec3{4.0}));
    const geometry::Vec3 here{1.0, 1.5, 2.0};
    const auto paths = room.paths(here, here, {.max_order = 0});
    ASSERT_EQ(paths.size(), 1U);
    EXPECT_EQ(paths[0].length, 0.0);
    EXPECT_TRUE(paths[0].triangles.empty());
}

TEST(Listeners, AreAnsweredEachAsIfAlone) {
    const TracedRoom room(reference_l_room());
    const geometry::Vec3 source = from_z_up(1.0, 4.6, 1.5);
    const std::array listeners = {
        from_z_up(4.4, 0.9, 1.2), from_z_up(5.0, 1.8, 1.2), from_z_up(9.0, 9.0, 1.0)};
    const auto together = room.trace(source, listeners, {.max_order = 3}).paths;
    std::vector<frustum::SpecularPath> one_by_one;
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        for (auto path : room.paths(source, listeners[i], {.max_order = 3})) {
            path.listener = i;
            one_by_one.push_back(path);
        }
    }
    EXPECT_EQ(together, one_by_one);
    EXPECT_TRUE(room.trace(source, {}, {.max_order = 3}).paths.empty());
}

}  // namespace
}  // namespace earshot::support
