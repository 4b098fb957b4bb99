// SPDX-License-Identifier: MIT
#include "earshot/io/report_page.h"

#include "earshot/base/error.h"
#include "earshot/base/sha256.h"
#include "earshot/io/internal/base64.h"
#include "earshot/io/internal/report_template.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <vector>

namespace earshot::io {
namespace {

// RFC 4648, section 10.
TEST(Base64, GivesTheTextsOfTheStandardsExamples) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foob"), "Zm9vYg==");
    EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xfb\xff\xfe"), "+//+");
}

TEST(Base64, WritesNumbersLittleEndian) {
    EXPECT_EQ(base64(std::vector<float>{1.0F}), base64(std::string_view("\x00\x00\x80\x3f", 4)));
    EXPECT_EQ(base64(std::vector<std::uint32_t>{0x04030201}), base64("\x01\x02\x03\x04"));
    EXPECT_EQ(base64(std::vector<std::uint16_t>{0x0201}), base64("\x01\x02"));
}

TEST(ReportPage, EscapesWhatCouldEndAScript) {
    const std::string name = "</script><!-- & \xe2\x80\xa8\xe2\x80\xa9 \xe2\x80\xaa";
    const std::string escaped = escape_for_script(nlohmann::json(name).dump());
    EXPECT_EQ(escaped.find_first_of("<>&"), std::string::npos);
    EXPECT_EQ(escaped.find("\xe2\x80\xa8"), std::string::npos);
    EXPECT_EQ(escaped.find("\xe2\x80\xa9"), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(escaped).get<std::string>(), name);
    EXPECT_EQ(escape_for_script("\xe2\x80"), "\xe2\x80");
}

TEST(ReportPage, PutsTheDataInThePlaceOfTheMarker) {
    EXPECT_EQ(assemble_report("<a>@EARSHOT_REPORT_DATA@</a>", "{\"x\":\"<@EARSHOT_REPORT_DATA@\"}"),
              "<a>{\"x\":\"\\u003c@EARSHOT_REPORT_DATA@\"}</a>");
    EXPECT_THROW(assemble_report("<a></a>", "{}"), Error);
    EXPECT_THROW(assemble_report("@EARSHOT_REPORT_DATA@@EARSHOT_REPORT_DATA@", "{}"), Error);
}

TEST(ReportPage, SaysHowToGetThePageWhereItIsMissing) {
    if (has_report_page()) {
        EXPECT_NO_THROW(require_report_page());
        return;
    }
    try {
        static_cast<void>(report_page("{}"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(error.line().find("report/bundle"), std::string::npos) << error.line();
        EXPECT_EQ(error.line().find('\n'), std::string::npos);
    }
}

/// The texts between all elements `<NAME>` without attributes and their ends.
std::vector<std::string_view> contents_of(std::string_view page, const std::string& name) {
    std::vector<std::string_view> contents;
    const std::string begin = "<" + name + ">";
    for (std::size_t at = page.find(begin); at != std::string_view::npos;
         at = page.find(begin, at + 1)) {
        const std::size_t first = at + begin.size();
        contents.push_back(page.substr(first, page.find("</" + name + ">", first) - first));
    }
    return contents;
}

std::string hash_source(std::string_view content) {
    const Sha256Digest digest = sha256(content);
    return "'sha256-" +
           base64(std::string_view(reinterpret_cast<const char*>(digest.data()), digest.size())) +
           "'";
}

TEST(ReportPage, AllowsByItsPolicyOnlyItsOwnScriptAndStyle) {
    if (!has_report_page()) {
        GTEST_SKIP() << "report/dist/page.html is not built";
    }
    const std::string page = report_page("{\"title\":\"<x>\"}");
    const std::size_t policy_at = page.find("Content-Security-Policy");
    ASSERT_NE(policy_at, std::string::npos);
    const std::size_t begin = page.find("content=\"", policy_at) + 9;
    const std::string policy = page.substr(begin, page.find('"', begin) - begin);
    EXPECT_NE(policy.find("default-src 'none'"), std::string::npos) << policy;
    EXPECT_EQ(policy.find("unsafe-eval"), std::string::npos) << policy;
    EXPECT_EQ(policy.find("http"), std::string::npos) << policy;
    for (const char* const name : {"script", "style"}) {
        const auto contents = contents_of(page, name);
        ASSERT_FALSE(contents.empty()) << name;
        for (const std::string_view content : contents) {
            EXPECT_NE(policy.find(hash_source(content)), std::string::npos) << name << policy;
        }
    }
    EXPECT_NE(page.find("{\"title\":\"\\u003cx\\u003e\"}"), std::string::npos);
}

}  // namespace
}  // namespace earshot::io
