// SPDX-License-Identifier: MIT
#include "earshot/io/whole_file.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <algorithm>
#include <sys/stat.h>
#include <unistd.h>

namespace earshot::io {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

std::string write_error(const fs::path& file) {
    try {
        write_whole_file(file, "x");
        return "no error";
    } catch (const Error& error) {
        EXPECT_FALSE(error.remedy().empty()) << error.line();
        return error.line();
    }
}

TEST(WholeFile, WritesWhatItReads) {
    const test::TemporaryFolder folder;
    std::string bytes(3'000'000, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<char>(i * 7 % 251);
    }
    write_whole_file(folder.path() / "a.bin", bytes);
    EXPECT_EQ(read_whole_file(folder.path() / "a.bin"), bytes);
    write_whole_file(folder.path() / "a.bin", "");
    EXPECT_EQ(read_whole_file(folder.path() / "a.bin"), "");
    EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(WholeFile, NewFilesHaveTheUsualRights) {
    const test::TemporaryFolder folder;
    const mode_t mask = ::umask(022);
    write_whole_file(folder.path() / "a", "x");
    ::umask(mask);
    EXPECT_EQ(fs::status(folder.path() / "a").permissions(), fs::perms{0644});
}

TEST(WholeFile, RefusesPlacesThatCannotHoldAFile) {
    const test::TemporaryFolder folder;
    folder.file("plain", "keep me");
    EXPECT_NE(write_error(folder.path()).find("is a directory"), std::string::npos);
    EXPECT_NE(write_error(folder.path() / "").find("is a directory"), std::string::npos);
    const std::string missing = write_error(folder.path() / "absent" / "a.wav");
    EXPECT_NE(missing.find("make the directory"), std::string::npos) << missing;
    const std::string in_file = write_error(folder.path() / "plain" / "a.wav");
    EXPECT_NE(in_file.find("make the directory"), std::string::npos) << in_file;
    EXPECT_EQ(entries(folder.path()), 1U);
    EXPECT_EQ(read_whole_file(folder.path() / "plain"), "keep me");
}

TEST(WholeFile, RefusesFoldersThatMayNotBeWritten) {
    if (::geteuid() == 0) {
        GTEST_SKIP() << "the superuser may write anywhere";
    }
    const test::TemporaryFolder folder;
    fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
    const std::string line = write_error(folder.path() / "a");
    fs::permissions(folder.path(), fs::perms::owner_all);
    EXPECT_NE(line.find("can be written to"), std::string::npos) << line;
    EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(WholeFile, LeavesNothingBehindWhenTheNameIsTooLong) {
    const test::TemporaryFolder folder;
    const std::string line = write_error(folder.path() / std::string(300, 'a'));
    EXPECT_NE(line.find("cannot be written"), std::string::npos) << line;
    EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(WholeFile, TakesItsBytesPieceByPiece) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "pieces";
    write_whole_file(file, [](const ByteSink& sink) {
        for (int i = 0; i < 3; ++i) {
            sink(std::to_string(i) + " ");
        }
    });
    EXPECT_EQ(read_whole_file(file), "0 1 2 ");
    // What fails on the way leaves the file that was there.
    const auto fails = [](const ByteSink& sink) {
        sink("half");
        throw Error("work", "failed");
    };
    EXPECT_THROW(write_whole_file(file, fails), Error);
    EXPECT_EQ(read_whole_file(file), "0 1 2 ");
    EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(WholeFile, ReadingNamesWhatIsMissing) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(read_whole_file(folder.path()), Error);
    try {
        read_whole_file(folder.path() / "absent");
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.subject(), (folder.path() / "absent").string());
        EXPECT_STREQ(error.what(), "no such file");
    }
}

}  // namespace
}  // namespace earshot::io
