// SPDX-License-Identifier: MIT
#include "earshot/io/escape.h"

#include <gtest/gtest.h>

namespace earshot::io {
namespace {

TEST(EscapeControls, LeavesTextAsItIs) {
    for (const char* text :
         {"", "brick-painted", "Caf\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x8E\xB5", "a\\b\"c"}) {
        EXPECT_EQ(escape_controls(text), text);
    }
}

TEST(EscapeControls, ShowsWhatATerminalWouldObey) {
    EXPECT_EQ(escape_controls("\x1b[31mred\x1b[0m"), R"(\u001b[31mred\u001b[0m)");
    EXPECT_EQ(escape_controls("two\nlines\r\t\x7f"), R"(two\u000alines\u000d\u0009\u007f)");
    EXPECT_EQ(escape_controls("\xC2\x9B"
                              "31m"),
              R"(\u009b31m)");  // CSI as one character
    EXPECT_EQ(escape_controls("\xE2\x80\xAE"
                              "txt"),
              R"(\u202etxt)");  // writes to the left
    EXPECT_EQ(escape_controls("a\xE2\x80\xA8"
                              "b"),
              R"(a\u2028b)");  // a line separator
    EXPECT_EQ(escape_controls(std::string_view("a\0b", 3)), R"(a\u0000b)");
}

TEST(EscapeControls, KeepsLineFeedsOfATableIfAsked) {
    EXPECT_EQ(escape_controls("a\nb\r\n", true), "a\nb\\u000d\n");
}

TEST(EscapeControls, ShowsBytesThatAreNotUtf8) {
    EXPECT_EQ(escape_controls("\x9b"
                              "31m"),
              R"(\x9b31m)");
    EXPECT_EQ(escape_controls("\xC0\x8A"), R"(\xc0\x8a)");          // an overlong line feed
    EXPECT_EQ(escape_controls("\xE0\x80\x9B"), R"(\xe0\x80\x9b)");  // an overlong C1
    EXPECT_EQ(escape_controls("\xED\xA0\x80"), R"(\xed\xa0\x80)");  // a surrogate
    EXPECT_EQ(escape_controls("\xF4\x90\x80\x80"), R"(\xf4\x90\x80\x80)");
    EXPECT_EQ(escape_controls("a\xE2\x82"), R"(a\xe2\x82)");  // cut off
}

}  // namespace
}  // namespace earshot::io
