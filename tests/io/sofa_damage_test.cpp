// SPDX-License-Identifier: MIT
// Damaged SOFA files, and damaged replies of the process that reads them.
#include "earshot/base/error.h"
#include "earshot/io/internal/child_process.h"
#include "earshot/io/internal/hrir_set.h"
#include "earshot/io/internal/sofa_file.h"
#include "earshot/io/sofa.h"

#include <gtest/gtest.h>

#include "support/sofa_builder.h"
#include "support/temporary_folder.h"
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <random>

namespace earshot::io {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// Copies of a file with some bytes changed or its end cut off; the same for a number everywhere.
std::string damaged_copy(const std::string& whole, std::size_t number) {
    std::mt19937 random(static_cast<std::uint32_t>(number));
    std::string bytes = whole;
    if (number % 10 == 0) {
        bytes.resize(random() % bytes.size());
        return bytes;
    }
    // Most of the structure lies in the first bytes.
    const std::size_t reach =
        number % 2 == 0 ? std::min<std::size_t>(4096, bytes.size()) : bytes.size();
    for (std::size_t change = 0; change < 1 + number % 8; ++change) {
        bytes[random() % reach] = static_cast<char>(random());
    }
    return bytes;
}

std::string compressed_file(const test::TemporaryFolder& folder) {
    test::SofaBuilder builder = test::synthetic_head_file();
    builder.is_compressed = true;
    builder.write(folder.path() / "head.sofa");
    return bytes_of(folder.path() / "head.sofa");
}

// Damaged copies end in a set or in one error, in time; a parser that crashes or hangs does so in a
// process of its own.
TEST(SofaDamage, EndsInASetOrAnError) {
    const test::TemporaryFolder folder;
    const std::string whole = compressed_file(folder);
    std::size_t refused = 0;
    constexpr std::size_t kCopies = 150;
    for (std::size_t number = 0; number < kCopies; ++number) {
        SCOPED_TRACE("copy " + std::to_string(number));
        const auto path = folder.file("head.sofa", damaged_copy(whole, number));
        try {
            read_hrir_set(path);
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(error.subject(), path.string());
            EXPECT_EQ(error.line().find('\n'), std::string::npos);
        }
    }
    EXPECT_GT(refused, kCopies / 4);
}

// Many more of them, a hundred to a process. What HDF5 does not survive ends its process and is
// HDF5's fault; whatever it reads must be a set or an Error.
TEST(SlowSofaDamage, OfTwentyThousandFilesEndsInASetOrAnError) {
    const test::TemporaryFolder folder;
    const std::string whole = compressed_file(folder);
    constexpr std::size_t kCopies = 20000;
    constexpr std::size_t kCopiesEach = 100;
    std::size_t copies = 0;
    std::size_t ended = 0;
    for (std::size_t begin = 0; begin < kCopies; begin += kCopiesEach) {
        const ChildResult result = run_in_child({}, [&](const ByteSink& sink) {
            for (std::size_t number = begin; number < begin + kCopiesEach; ++number) {
                const auto path = folder.file("head.sofa", damaged_copy(whole, number));
                SofaFile sofa;
                try {
                    sofa = read_sofa_in_process(path);
                } catch (const Error&) {
                    sink("e");
                    continue;
                }
                sink("r");
                try {
                    hrir_set_of(sofa, path.string());
                } catch (const Error&) {
                }
                sink("s");
            }
        });
        copies += result.output.size();
        // HDF5 ended it unless an `r` without its `s` is last.
        if (result.end != ChildEnd::finished) {
            ++ended;
            EXPECT_TRUE(result.output.empty() || result.output.back() != 'r')
                << "after copy " << begin << ", " << result.output;
        }
    }
    EXPECT_GT(copies, kCopies);
    EXPECT_LT(ended, kCopies / kCopiesEach / 10);
    RecordProperty("processes_that_hdf5_ended", static_cast<int>(ended));
}

// What a damaged file may make of the process that reads it: any bytes.
TEST(SofaDamage, RepliesOfTheChildAreNotTrusted) {
    const test::TemporaryFolder folder;
    test::SofaBuilder builder = test::synthetic_head_file();
    builder.write(folder.path() / "head.sofa");
    const SofaFile sofa = read_sofa(folder.path() / "head.sofa");
    std::string reply;
    send_sofa_reply(sofa, [&](std::string_view bytes) { reply += bytes; });
    EXPECT_EQ(hrir_set_of(decode_sofa_reply(reply, "f"), "f").directions.size(),
              test::SyntheticHead::kMeasurements);
    const auto decode = [](const std::string& bytes) {
        try {
            hrir_set_of(decode_sofa_reply(bytes, "f"), "f");
        } catch (const Error& error) {
            EXPECT_EQ(error.subject(), "f");
        }
    };
    for (std::size_t size = 0; size < reply.size(); size += size < 600 ? 1 : 97) {
        EXPECT_THROW(decode_sofa_reply(reply.substr(0, size), "f"), Error) << size;
    }
    for (std::size_t number = 1; number < 3000; ++number) {
        SCOPED_TRACE("copy " + std::to_string(number));
        decode(damaged_copy(reply, number));
    }
}

}  // namespace
}  // namespace earshot::io
