// SPDX-License-Identifier: MIT
// Specular paths against tables made by a brute-force search elsewhere (tests/data/paths).
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/image_source_oracle.h"
#include "support/path_facts.h"
#include "support/path_table.h"
#include "support/traced_room.h"
#include "truth/reference_cases.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace earshot::support {
namespace {

// The tables carry 16 digits; lengths stay below 30 m.
constexpr double kTolerance = 1e-9;

class ReferencePaths : public testing::TestWithParam<ReferenceCase> {};

TEST_P(ReferencePaths, MatchEveryLineOnce) {
    const ReferenceCase& test = GetParam();
    const Room room = test.room();
    auto paths =
        facts_of(TracedRoom(room).paths(test.source, test.listener, {.max_order = test.max_order}),
                 room.labels);

    // What meets an edge exactly may be reported once; the oracle knows where it runs.
    const std::array listeners = {test.listener};
    const OracleResult oracle = search_image_sources(
        room.mesh.view(), room.labels, test.source, listeners, {.max_order = test.max_order});
    ASSERT_EQ(oracle.ambiguous.size(), test.ambiguous);
    for (const PathFacts& optional : facts_of(oracle.ambiguous)) {
        const auto found = std::find_if(paths.begin(), paths.end(), [&](const PathFacts& path) {
            return path.order == optional.order &&
                   std::abs(path.length - optional.length) <= kTolerance &&
                   glm::length(path.image - optional.image) <= kTolerance;
        });
        if (found != paths.end()) {
            paths.erase(found);
        }
    }
    EXPECT_EQ(disagreement(paths, read_path_table(test.table), kTolerance), "");
}

INSTANTIATE_TEST_SUITE_P(Tables,
                         ReferencePaths,
                         testing::ValuesIn(reference_cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace earshot::support
