// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/mutation_candidates.h"

#include <gtest/gtest.h>

#include <vector>

namespace earshot::visibility {
namespace {

std::vector<ObjectId> taken(MutationCandidates& store, int count) {
    std::vector<ObjectId> objects;
    for (int i = 0; i < count; ++i) {
        objects.push_back(store.select()->object);
    }
    return objects;
}

TEST(MutationCandidates, SelectsTheLeastMutatedFirst) {
    MutationCandidates store;
    EXPECT_FALSE(store.select());
    store.add({.object = 1});
    store.add({.object = 2});
    EXPECT_EQ(taken(store, 3), (std::vector<ObjectId>{1, 2, 1}));
    store.add({.object = 3});
    EXPECT_EQ(taken(store, 5), (std::vector<ObjectId>{3, 2, 3, 1, 2}));
}

TEST(MutationCandidates, DropsTheMostMutatedWhenFull) {
    MutationCandidates store(2);
    store.add({.object = 1});
    EXPECT_EQ(taken(store, 2), (std::vector<ObjectId>{1, 1}));
    store.add({.object = 2});
    store.add({.object = 3});
    EXPECT_EQ(store.size(), 2U);
    EXPECT_EQ(taken(store, 4), (std::vector<ObjectId>{2, 3, 2, 3}));
}

// A scene in which little is found varies that all the time.
TEST(MutationCandidates, KeepsItsSizeThroughManySelections) {
    MutationCandidates store;
    store.add({.object = 1});
    store.add({.object = 2});
    for (int i = 0; i < 10001; ++i) {
        store.select();
        ASSERT_LE(store.levels(), store.size());
    }
    EXPECT_EQ(store.select()->object, 2U);
}

}  // namespace
}  // namespace earshot::visibility
