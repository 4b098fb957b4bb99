// SPDX-License-Identifier: MIT
#include "earshot/base/digest.h"

#include <gtest/gtest.h>

#include <string_view>

namespace earshot {
namespace {

std::uint64_t digest_of(std::string_view text) {
    Digest digest;
    digest.add_bytes(std::as_bytes(std::span(text.data(), text.size())));
    return digest.value();
}

TEST(Digest, IsTheFnv1aOfItsBytes) {
    // Test vectors of the authors (Fowler, Noll, Vo, Eastlake, Hansen 2019, appendix C).
    EXPECT_EQ(digest_of(""), 0xcbf29ce484222325ULL);
    EXPECT_EQ(digest_of("a"), 0xaf63dc4c8601ec8cULL);
    EXPECT_EQ(digest_of("foobar"), 0x85944171f73967e8ULL);
}

TEST(Digest, DoesNotCareHowTheBytesArrive) {
    Digest parts;
    for (const char letter : std::string_view("foobar")) {
        parts.add(letter);
    }
    EXPECT_EQ(parts.value(), digest_of("foobar"));
}

TEST(Digest, TellsNumbersThatCompareEqualApart) {
    Digest plus;
    Digest minus;
    plus.add(0.0);
    minus.add(-0.0);
    EXPECT_NE(plus.value(), minus.value());
}

}  // namespace
}  // namespace earshot
