// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"

#include <gtest/gtest.h>

namespace earshot {
namespace {

TEST(Error, PrintsSubjectWhatAndRemedyOnOneLine) {
    const Error error("hall.gltf", "has no triangles", "add a mesh");
    EXPECT_EQ(error.line(), "hall.gltf: has no triangles; add a mesh");
    EXPECT_STREQ(error.what(), "has no triangles");
    EXPECT_EQ(error.subject(), "hall.gltf");
    EXPECT_EQ(error.remedy(), "add a mesh");
}

TEST(Error, LeavesOutWhatIsNotSaid) {
    EXPECT_EQ(Error("", "out of memory").line(), "out of memory");
    EXPECT_EQ(Error("a", "is wrong").line(), "a: is wrong");
    EXPECT_EQ(Error("", "is wrong", "mend it").line(), "is wrong; mend it");
}

TEST(Error, CanBeCaughtAsAStandardException) {
    EXPECT_THROW(throw Error("a", "b"), std::runtime_error);
}

}  // namespace
}  // namespace earshot
