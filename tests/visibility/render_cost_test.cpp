// SPDX-License-Identifier: MIT
#include "earshot/visibility/render_cost.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include <limits>

namespace earshot::visibility {
namespace {

TEST(RenderCost, IsTheLargerOfItsParts) {
    const Objects objects(std::vector<ObjectId>{0, 1, 1, 2, 2, 2});
    EXPECT_EQ(object_costs(objects), (std::vector<double>{1.0, 2.0, 3.0}));
    EXPECT_EQ(object_costs(objects, {5.0, 2.0}), (std::vector<double>{5.0, 5.0, 6.0}));
    EXPECT_TRUE(object_costs(Objects::triangles(0)).empty());
}

TEST(RenderCost, OfASetIsTheSum) {
    const std::vector<double> costs = {1.0, 2.0, 4.0, 8.0};
    EXPECT_EQ(set_cost({}, costs), 0.0);
    EXPECT_EQ(set_cost(std::vector<ObjectId>{0, 3}, costs), 9.0);
}

TEST(RenderCost, RefusesInvalidCosts) {
    const Objects objects = Objects::triangles(1);
    EXPECT_THROW(object_costs(objects, {-1.0, 1.0}), Error);
    EXPECT_THROW(object_costs(objects, {1.0, std::numeric_limits<double>::infinity()}), Error);
}

TEST(RenderCost, FormsUnionsOfSets) {
    using Set = std::vector<ObjectId>;
    EXPECT_EQ(union_of(Set{0, 2, 5}, Set{1, 2, 9}), (Set{0, 1, 2, 5, 9}));
    EXPECT_EQ(union_of(Set{}, Set{4}), Set{4});
}

}  // namespace
}  // namespace earshot::visibility
