// SPDX-License-Identifier: MIT
// Seeds, findings and seeded mutations of both, through every reader, with bounds of time and
// memory: what libFuzzer does, as far as it goes without clang.
#include <gtest/gtest.h>

#include "fuzz/dictionary.h"
#include "fuzz/limits.h"
#include "fuzz/mutator.h"
#include "fuzz/readers.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;

struct Input {
    std::string name;
    std::string bytes;
};

/// The files of tests/fuzz/KIND/READER, by name.
std::vector<Input> inputs_of(const std::string& kind, const Reader& reader) {
    std::vector<Input> inputs;
    std::error_code ignored;
    for (const auto& entry :
         fs::directory_iterator(source_file("tests/fuzz/" + kind) / reader.name, ignored)) {
        std::ifstream stream(entry.path(), std::ios::binary);
        inputs.push_back(
            {entry.path().filename().string(), {std::istreambuf_iterator<char>(stream), {}}});
    }
    std::sort(inputs.begin(), inputs.end(), [](const Input& a, const Input& b) {
        return a.name < b.name;
    });
    return inputs;
}

class Replay : public testing::TestWithParam<Reader> {
protected:
    void SetUp() override {
        std::printf("The last input stays in %s if the reader ends the process.\n",
                    input_file(GetParam()).c_str());
        std::fflush(stdout);
        limit_memory();
    }

    /// Counts the outcome; a finding fails the test.
    void run(const std::string& name, std::string_view bytes) {
        restart_time_limit();
        const double begin = processor_seconds();
        try {
            ++(fuzz_one(GetParam(), bytes) == Outcome::read ? read_ : refused_);
        } catch (const std::exception& fault) {
            ADD_FAILURE() << GetParam().name << ", " << name << ": " << fault.what();
        }
        const double seconds = processor_seconds() - begin;
        if (seconds > slowest_seconds_) {
            slowest_seconds_ = seconds;
            slowest_ = name;
        }
    }

    std::size_t read_ = 0, refused_ = 0;
    double slowest_seconds_ = 0.0;
    std::string slowest_;
};

TEST_P(Replay, SeedsAreRead) {
    const std::vector<Input> seeds = inputs_of("seeds", GetParam());
    ASSERT_FALSE(seeds.empty());
    for (const Input& seed : seeds) {
        refused_ = 0;
        run(seed.name, seed.bytes);
        EXPECT_EQ(refused_, 0U) << seed.name << " is refused";
    }
}

TEST_P(Replay, FindingsAreReadOrRefused) {
    for (const Input& finding : inputs_of("findings", GetParam())) {
        run(finding.name, finding.bytes);
    }
}

TEST_P(Replay, MutationsAreReadOrRefused) {
    constexpr std::uint64_t kMutations = 20000;
    const Reader& reader = GetParam();
    std::vector<std::string> seeds;
    for (const char* kind : {"seeds", "findings"}) {
        for (Input& input : inputs_of(kind, reader)) {
            seeds.push_back(std::move(input.bytes));
        }
    }
    ASSERT_FALSE(seeds.empty());
    const fs::path dictionary = source_file("tests/fuzz/dictionaries") / (reader.name + ".dict");
    const Mutator mutator(seeds, read_dictionary(dictionary));
    for (std::uint64_t number = 0; number < kMutations; ++number) {
        std::string bytes = mutator.mutated(number);
        // One of 16 is left as it is.
        if (reader.repair != nullptr && number % 16 != 0) {
            bytes = reader.repair(std::move(bytes));
        }
        run("mutation " + std::to_string(number), bytes);
        if (HasFailure()) {
            const fs::path kept = fs::path(testing::TempDir()) / ("fuzz-" + reader.name);
            std::ofstream(kept, std::ios::binary) << bytes;
            FAIL() << "the input is kept as " << kept;
        }
    }
    // Else the seeds are none, or the mutations change nothing.
    EXPECT_GT(read_, kMutations / 100);
    EXPECT_GT(refused_, kMutations / 100);
    std::printf("%s: %zu read, %zu refused, slowest %.3f s (%s)\n",
                reader.name.c_str(),
                read_,
                refused_,
                slowest_seconds_,
                slowest_.c_str());
}

INSTANTIATE_TEST_SUITE_P(Readers, Replay, testing::ValuesIn(readers()), [](const auto& test) {
    return test.param.name;
});

}  // namespace
}  // namespace earshot::test
