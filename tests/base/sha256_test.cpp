// SPDX-License-Identifier: MIT
#include "earshot/base/sha256.h"

#include <gtest/gtest.h>

namespace earshot {
namespace {

// Vectors of FIPS 180-4's examples (NIST, "Cryptographic Standards and Guidelines: Examples").
TEST(Sha256, GivesTheDigestsOfTheStandardsExamples) {
    EXPECT_EQ(hex_text(sha256("")),
              "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(hex_text(sha256("abc")),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(hex_text(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(hex_text(sha256("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmn"
                              "hijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu")),
              "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
    EXPECT_EQ(hex_text(sha256(std::string(1000000, 'a'))),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, GivesTheSameDigestHoweverTheBytesAreDivided) {
    const std::string text(200, 'x');
    for (std::size_t first = 0; first <= text.size(); ++first) {
        Sha256 hash;
        hash.add(std::string_view(text).substr(0, first));
        hash.add(std::string_view(text).substr(first));
        EXPECT_EQ(hash.finish(), sha256(text)) << first;
    }
}

}  // namespace
}  // namespace earshot
