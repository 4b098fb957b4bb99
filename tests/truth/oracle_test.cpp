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

}  // namespace
}  // namespace earshot::support
