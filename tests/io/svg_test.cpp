// SPDX-License-Identifier: MIT
#include "earshot/io/svg.h"

#include <gtest/gtest.h>

#include <array>

namespace earshot::io {
namespace {

const std::string kHead =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 200 100\" font-family=\"sans-serif\" "
    "font-size=\"12\">\n";
const std::string kPaper = "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";

TEST(SvgAxis, IsLinearBetweenItsEnds) {
    const SvgAxis axis{.first = -10.0, .last = 10.0, .begin = 300.0, .end = 100.0};
    EXPECT_EQ(axis.at(-10.0), 300.0);
    EXPECT_EQ(axis.at(0.0), 200.0);
    EXPECT_EQ(axis.at(10.0), 100.0);
    EXPECT_EQ((SvgAxis{.first = 2.0, .last = 2.0, .begin = 0.0, .end = 8.0}.at(2.0)), 4.0);
}

TEST(SvgPicture, TextWidthsCountCharacters) {
    EXPECT_EQ(svg_text_width("", 10.0), 0.0);
    EXPECT_DOUBLE_EQ(svg_text_width("wall", 10.0), 4 * 6.2);
    EXPECT_DOUBLE_EQ(svg_text_width("M\u00fcll", 10.0), 4 * 6.2);
    EXPECT_DOUBLE_EQ(svg_text_width("\u5ef3\U0001f50a", 10.0), 2 * 10.0);
}

TEST(SvgPicture, IsADocumentOfOneElementPerLine) {
    SvgPicture picture(200.0, 100.0, 12.0, "a & b");
    picture.line({0.0, 1.25}, {10.04, -0.01}, "red");
    picture.polyline(std::array{SvgPoint{1, 2}, SvgPoint{3, 4}, SvgPoint{5, 6.5}}, "#123", 2.0);
    picture.polylines(
        std::array<std::vector<SvgPoint>, 3>{{{{0, 0}, {1, 1}}, {{9, 9}}, {{2, 2}, {3, 3}}}},
        "blue");
    picture.polylines(std::array<std::vector<SvgPoint>, 1>{{{{9, 9}}}}, "green");
    picture.disc({4.0, 5.0}, 2.5, "white", "x < y");
    picture.disc({4.0, 5.0}, 2.5, "white");
    picture.text({1.0, 2.0}, "\"5 > 4\"");
    picture.text({1.0, 2.0}, "b", {.fill = "red", .anchor = "end", .size = 14.0, .halo = true});
    EXPECT_EQ(picture.str(),
              kHead + "<title>a &amp; b</title>\n" + kPaper +
                  "<path fill=\"none\" stroke=\"red\" d=\"M0 1.2L10 0\"/>\n"
                  "<path fill=\"none\" stroke=\"#123\" stroke-width=\"2\" d=\"M1 2L3 4L5 6.5\"/>\n"
                  "<path fill=\"none\" stroke=\"blue\" d=\"M0 0L1 1M2 2L3 3\"/>\n"
                  "<circle cx=\"4\" cy=\"5\" r=\"2.5\" fill=\"white\"><title>x &lt; "
                  "y</title></circle>\n"
                  "<circle cx=\"4\" cy=\"5\" r=\"2.5\" fill=\"white\"/>\n"
                  "<text x=\"1\" y=\"2\">&quot;5 &gt; 4&quot;</text>\n"
                  "<text x=\"1\" y=\"2\" text-anchor=\"end\" font-size=\"14\" fill=\"red\" "
                  "stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">b</text>\n"
                  "</svg>\n");
}

TEST(SvgPicture, RectanglesHaveTheirLeastCornerFirst) {
    SvgPicture picture(200.0, 100.0, 12.0);
    picture.rectangle({3.0, 9.0}, {1.0, 4.5}, "#abc");
    picture.rectangle({1.0, 2.0}, {3.0, 4.0}, "red", "a < b");
    EXPECT_EQ(picture.str(),
              kHead + kPaper +
                  "<rect x=\"1\" y=\"4.5\" width=\"2\" height=\"4.5\" fill=\"#abc\"/>\n"
                  "<rect x=\"1\" y=\"2\" width=\"2\" height=\"2\" fill=\"red\"><title>a &lt; "
                  "b</title></rect>\n</svg>\n");
}

TEST(SvgPicture, AxesAreTwoSidesWithTheirLabels) {
    SvgPicture picture(200.0, 100.0, 12.0);
    picture.axes({0.0, 2.0, 40.0, 180.0, {0.0, 2.0}, " s"}, {0.0, 8.0, 80.0, 10.0, {4.0}, " dB"});
    EXPECT_EQ(picture.str(),
              kHead + kPaper +
                  "<path fill=\"none\" stroke=\"black\" d=\"M40 10L40 80L180 80\"/>\n"
                  "<text x=\"34\" y=\"49\" text-anchor=\"end\">4 dB</text>\n"
                  "<text x=\"40\" y=\"98\" text-anchor=\"middle\">0 s</text>\n"
                  "<text x=\"180\" y=\"98\" text-anchor=\"middle\">2 s</text>\n"
                  "</svg>\n");
}

}  // namespace
}  // namespace earshot::io
