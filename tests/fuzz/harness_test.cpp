// SPDX-License-Identifier: MIT
// What the fuzzing itself promises: findings are told, limits hold, mutations repeat.
#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "fuzz/dictionary.h"
#include "fuzz/limits.h"
#include "fuzz/mutator.h"
#include "fuzz/readers.h"
#include "fuzz/repair.h"
#include "support/temporary_folder.h"
#include <fstream>
#include <new>
#include <set>
#include <stdexcept>

namespace earshot::test {
namespace {

TEST(FuzzOne, GivesTheReaderAFileOfTheseBytes) {
    const Reader reader{"text", ".txt", [](const std::filesystem::path& file) {
                            std::string text;
                            std::ifstream(file) >> text;
                            if (text != "good" || file.extension() != ".txt") {
                                throw Error(file.string(), "is \"" + text + "\"");
                            }
                        }};
    EXPECT_EQ(fuzz_one(reader, "good"), Outcome::read);
    EXPECT_EQ(fuzz_one(reader, "goodness"), Outcome::refused);
    EXPECT_EQ(fuzz_one(reader, "good"), Outcome::read);
    EXPECT_EQ(fuzz_one(reader, ""), Outcome::refused);
}

TEST(FuzzOne, TellsWhatIsNoError) {
    const Reader throws{
        "throws", ".x", [](const std::filesystem::path&) { throw std::runtime_error("no Error"); }};
    EXPECT_THROW(fuzz_one(throws, ""), std::runtime_error);
    const Reader needs_memory{"needs_memory", ".x", [](const std::filesystem::path& file) {
                                  throw Error(file.string(), "needs more memory than is available");
                              }};
    EXPECT_THROW(fuzz_one(needs_memory, ""), std::bad_alloc);
}

TEST(FuzzLimits, RefuseMemory) {
    if (has_address_sanitizer()) {
        GTEST_SKIP() << "the sanitizer has its own limit";
    }
    EXPECT_EXIT(
        {
            limit_memory();
            std::vector<char> half(kMaxInputBytes / 2);
            try {
                const std::vector<char> rest(kMaxInputBytes / 2);
                std::exit(rest.empty() ? 2 : 1);
            } catch (const std::bad_alloc&) {
                std::exit(half.front());
            }
        },
        testing::ExitedWithCode(0),
        "");
}

TEST(Mutator, RepeatsItselfAndVaries) {
    const std::vector<std::string> seeds{"v 0.5 1 2\nf 1 2 3\n", "solid"};
    const Mutator first(seeds, {"token"});
    const Mutator second(seeds, {"token"});
    std::set<std::string> different;
    bool has_token = false;
    for (std::uint64_t number = 0; number < 1000; ++number) {
        const std::string bytes = first.mutated(number);
        ASSERT_EQ(bytes, second.mutated(number));
        different.insert(bytes);
        has_token = has_token || bytes.find("token") != std::string::npos;
    }
    EXPECT_GT(different.size(), 500U);
    EXPECT_TRUE(has_token);
}

TEST(Mutator, TakesEmptySeeds) {
    const Mutator mutator({""}, {});
    for (std::uint64_t number = 0; number < 100; ++number) {
        EXPECT_EQ(mutator.mutated(number), "");
    }
}

TEST(Dictionary, IsReadAsLibFuzzerReadsIt) {
    const TemporaryFolder folder;
    const auto file = folder.file("a.dict", "# tokens\n\nname=\"a\\x00b\"\n\"q\\\"\\\\\"\n");
    EXPECT_EQ(read_dictionary(file), (std::vector<std::string>{std::string("a\0b", 3), "q\"\\"}));
    EXPECT_TRUE(read_dictionary(folder.path() / "none").empty());
    EXPECT_THROW(read_dictionary(folder.file("b.dict", "token\n")), std::runtime_error);
}

TEST(Repair, PutsLengthsRight) {
    EXPECT_EQ(repair_wav("RIFF____WAVE").substr(4, 4), std::string("\4\0\0\0", 4));
    EXPECT_EQ(repair_stl(std::string(84 + 2 * 50 + 7, 'x')).substr(80, 4),
              std::string("\2\0\0\0", 4));
    const std::string glb = repair_glb("glTF____********JSON{}  ****" + std::string("BIN\0abc", 7));
    EXPECT_EQ(glb.substr(8, 8), std::string("\x23\0\0\0\4\0\0\0", 8));
    EXPECT_EQ(glb.substr(24, 4), std::string("\3\0\0\0", 4));
    for (const auto repair : {repair_glb, repair_stl, repair_visible_sets, repair_wav}) {
        EXPECT_EQ(repair("abc"), "abc");
    }
}

}  // namespace
}  // namespace earshot::test
