// SPDX-License-Identifier: MIT
#include "earshot/io/visibility_file.h"

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/io/internal/bytes.h"
#include "earshot/io/whole_file.h"
#include "earshot/visibility/merge_cells.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {
namespace {

using visibility::ObjectId;
using visibility::VisibleSets;

constexpr std::uint64_t kSeed = 17;

/// Sets drawn at random over a grid, of objects of two triangles each.
VisibleSets made_sets(bool with_history) {
    constexpr ObjectId kObjects = 300;
    const auto cells = visibility::ViewCells::grid({{-1.0, 0.5, 2.0}, {3.0, 4.0, 8.0}}, {3, 4, 2});
    std::vector<ObjectId> object_of_triangle;
    for (ObjectId i = 0; i < 2 * kObjects; ++i) {
        object_of_triangle.push_back(i % kObjects);
    }
    std::vector<std::vector<ObjectId>> sets(cells.size());
    for (std::size_t cell = 0; cell < sets.size(); ++cell) {
        for (ObjectId object = 0; object < kObjects; ++object) {
            if (random(kSeed, cell, object) < 0.2) {
                sets[cell].push_back(object);
            }
        }
    }
    const std::vector<double> costs(kObjects, 2.0);
    const visibility::SetsProvenance provenance = {
        .scene = "made",
        .time = 1.5,
        .mesh_digest = 0xfedcba9876543210ULL,
        .seed = 7,
        .rays = 123'456'789'012ULL,
        .validation = visibility::MissedShare{.rays = 65536, .missed = 7}};
    if (!with_history) {
        std::vector<visibility::CellId> halves(cells.leaves(), 0);
        halves.back() = 1;
        sets.resize(2);
        return {cells.merged(halves), visibility::Objects(object_of_triangle), sets, provenance};
    }
    const auto history = visibility::merge_cells(cells, sets, costs);
    return {cells, visibility::Objects(object_of_triangle), sets, provenance, history};
}

class VisibilityFile : public testing::Test {
protected:
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    /// What reading these bytes says; empty if nothing is wrong.
    std::string fault_of(const std::string& bytes) const {
        write_whole_file(path("faulty"), bytes);
        try {
            read_visible_sets(path("faulty"));
        } catch (const Error& error) {
            EXPECT_EQ(error.subject(), path("faulty"));
            return error.what();
        }
        return {};
    }

    const test::TemporaryFolder folder_;
};

TEST_F(VisibilityFile, IsReadAsItWasWrittenAndWrittenAsItWasRead) {
    for (const bool with_history : {false, true}) {
        const VisibleSets sets = made_sets(with_history);
        write_visible_sets(path("a"), sets);
        const VisibleSets again = read_visible_sets(path("a"));
        EXPECT_EQ(again, sets);
        write_visible_sets(path("b"), again);
        EXPECT_EQ(read_whole_file(path("b")), read_whole_file(path("a")));
    }
}

TEST_F(VisibilityFile, IsRefusedWhereverItIsCutOff) {
    write_visible_sets(path("a"), made_sets(true));
    const std::string bytes = read_whole_file(path("a"));
    for (std::size_t length = 0; length < bytes.size(); length += 3) {
        ASSERT_FALSE(fault_of(bytes.substr(0, length)).empty()) << length << " bytes";
    }
    EXPECT_FALSE(fault_of(bytes + "x").empty());
}

TEST_F(VisibilityFile, IsRefusedIfAByteIsWrong) {
    write_visible_sets(path("a"), made_sets(true));
    const std::string bytes = read_whole_file(path("a"));
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::string wrong = bytes;
        wrong[i] = static_cast<char>(wrong[i] ^ 0x10);
        ASSERT_FALSE(fault_of(wrong).empty()) << "byte " << i;
    }
}

std::string with_checksum(const std::string& body) {
    Digest digest;
    digest.add_bytes(std::as_bytes(std::span(body)));
    ByteWriter checksum;
    checksum.fixed(digest.value(), 8);
    return body + checksum.bytes();
}

// Triangle 0 is of object 2^32: not of object 0.
TEST_F(VisibilityFile, IsRefusedIfANumberIsTooLargeForWhatItNames) {
    const VisibleSets sets = {visibility::ViewCells({{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}),
                              visibility::Objects::triangles(1),
                              {{0}},
                              {}};
    write_visible_sets(path("a"), sets);
    const std::string bytes = read_whole_file(path("a"));
    const std::string body = bytes.substr(0, bytes.size() - 8);
    // At the end: one triangle, of object 0, one set of one object, 0, and no history.
    ASSERT_EQ(body.substr(body.size() - 5), std::string("\x01\x00\x01\x00\x00", 5));
    ByteWriter wrong;
    wrong.raw(std::string_view(body).substr(0, body.size() - 4));
    wrong.leb128(std::uint64_t{1} << 32U);
    wrong.raw(std::string_view(body).substr(body.size() - 3));
    EXPECT_EQ(fault_of(with_checksum(body)), "");
    EXPECT_NE(fault_of(with_checksum(wrong.bytes())).find("too large"), std::string::npos);
}

// With a checksum that fits, nothing but an Error or a proper file may come of any bytes.
TEST_F(VisibilityFile, OutlivesBytesThatAreWrongInEveryPlace) {
    write_visible_sets(path("a"), made_sets(true));
    const std::string bytes = read_whole_file(path("a"));
    const std::string body = bytes.substr(0, bytes.size() - 8);
    std::size_t refused = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        std::string wrong = body;
        const std::size_t place = 12 + random_bits(kSeed, 1, i) % (wrong.size() - 12);
        wrong[place] = static_cast<char>(random_bits(kSeed, 2, i));
        refused += fault_of(with_checksum(wrong)).empty() ? 0 : 1;
    }
    EXPECT_GT(refused, 25U);
}

// Version 1 held an estimate that was 0 where nothing was known: it is read as not known.
TEST_F(VisibilityFile, OfVersionOneHasNoValidation) {
    VisibleSets sets = made_sets(true);
    write_visible_sets(path("a"), sets);
    const std::string bytes = read_whole_file(path("a"));
    std::string body = bytes.substr(0, bytes.size() - 8);
    // After magic, version, name (a length and 4 letters), time, digest, seed and rays (6 bytes):
    // 65536 (3 bytes) and 7.
    const std::size_t place = 8 + 4 + 5 + 8 + 8 + 1 + 6;
    ASSERT_EQ(body.substr(place, 4), std::string("\x80\x80\x04\x07", 4));
    ByteWriter share;
    share.number(0.0);
    body.replace(place, 4 + 8, share.bytes());
    body[8] = 1;
    write_whole_file(path("old"), with_checksum(body));
    const VisibleSets old = read_visible_sets(path("old"));
    EXPECT_FALSE(old.provenance().validation);
    EXPECT_EQ(old.provenance().rays, sets.provenance().rays);
    EXPECT_TRUE(
        std::equal(old.sets().begin(), old.sets().end(), sets.sets().begin(), sets.sets().end()));
    EXPECT_EQ(old.history(), sets.history());
}

TEST_F(VisibilityFile, IsRefusedIfMoreRaysAreMissedThanThereAre) {
    write_visible_sets(path("a"), made_sets(true));
    std::string body = read_whole_file(path("a"));
    body.resize(body.size() - 8);
    const std::size_t place = 8 + 4 + 5 + 8 + 8 + 1 + 6;
    body.replace(place, 4, std::string("\x06\x07", 2));
    EXPECT_NE(fault_of(with_checksum(body)).find("more rays are missed"), std::string::npos);
}

TEST_F(VisibilityFile, SaysWhatIsWrong) {
    EXPECT_NE(fault_of("solid stl").find("is not a file of visible sets"), std::string::npos);
    std::string future = "earshotV";
    future += std::string("\x03\x00\x00\x00", 4) + std::string(40, ' ');
    EXPECT_NE(fault_of(future).find("has version 3"), std::string::npos);
    EXPECT_THROW(read_visible_sets(path("missing")), Error);
    EXPECT_THROW(write_visible_sets(path("no/folder"), made_sets(false)), Error);
}

TEST(Bytes, Leb128NumbersAreShortAndWhole) {
    ByteWriter out;
    const std::vector<std::uint64_t> values = {
        0, 1, 127, 128, 300, 1ULL << 32U, std::numeric_limits<std::uint64_t>::max()};
    for (const std::uint64_t value : values) {
        out.leb128(value);
    }
    out.number(-0.1);
    EXPECT_EQ(out.bytes().substr(3, 2), "\x80\x01");
    ByteReader in(out.bytes(), "here");
    for (const std::uint64_t value : values) {
        EXPECT_EQ(in.leb128(), value);
    }
    EXPECT_EQ(in.number(), -0.1);
    EXPECT_EQ(in.remaining(), 0U);
    EXPECT_THROW(in.fixed(1), Error);
    EXPECT_THROW(ByteReader("\xff\xff\xff\xff\xff\xff\xff\xff\xff\x02", "here").leb128(), Error);
    EXPECT_THROW(ByteReader("\x05"
                            "abc",
                            "here")
                     .string(),
                 Error);
}

}  // namespace
}  // namespace earshot::io
