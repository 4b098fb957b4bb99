// SPDX-License-Identifier: MIT
// How the text formats cut their bytes into lines, words and records. Every expected surface was
// written down by hand.
#include "earshot/io/internal/text.h"
#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include "triangle_soup.h"
#include <array>
#include <cmath>
#include <utility>

namespace earshot::io {
namespace {

using geometry::Vec3;

const Vec3 kA(0, 0, 0), kB(1, 0, 0), kC(1, 1, 0), kD(0, 1, 0);
const Soup kOneTriangle = {{kA, kB, kC}};
const Soup kSquare = {{kA, kB, kC}, {kA, kC, kD}};

void expect_read(const std::string& name, const std::string& bytes, const Soup& want) {
    const ReadSoup result = read_soup(name, bytes);
    EXPECT_EQ(result.error, "") << bytes;
    EXPECT_EQ(result.soup, want) << bytes;
    EXPECT_EQ(result.warnings, "") << bytes;
}

void expect_warned(const std::string& name,
                   const std::string& bytes,
                   const Soup& want,
                   const std::string& part) {
    const ReadSoup result = read_soup(name, bytes);
    EXPECT_EQ(result.error, "") << bytes;
    EXPECT_EQ(result.soup, want) << bytes;
    EXPECT_NE(result.warnings.find(part), std::string::npos) << result.warnings;
}

void expect_refused(const std::string& name, const std::string& bytes, const std::string& part) {
    const ReadSoup result = read_soup(name, bytes);
    EXPECT_NE(result.error.find(part), std::string::npos) << bytes << "\n" << result.error;
}

const std::string kMark = "\xEF\xBB\xBF";
const std::string kObjPoints = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::string with_line_ends(std::string text, const std::string& end) {
    for (std::size_t at = text.find('\n'); at != std::string::npos;
         at = text.find('\n', at + end.size())) {
        text.replace(at, 1, end);
    }
    return text;
}

std::string utf16(const std::string& text, bool big_endian, bool with_mark) {
    std::string bytes = with_mark ? (big_endian ? "\xFE\xFF" : "\xFF\xFE") : "";
    for (const char c : text) {
        bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
    }
    return bytes;
}

std::string ply(const std::string& elements, const std::string& body) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

const std::string kFour =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kOneFace = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kPoints = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string kOff = "OFF\n4 1 0\n" + kPoints + "4 0 1 2 3\n";
const std::string kFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n"
    "endfacet\n";
const std::string kStl = "solid a\n" + kFacet + "endsolid a\n";

TEST(MeshText, AUtf8MarkIsNoPartOfAnyFormat) {
    expect_read("a.obj", kMark + kObjPoints + "f 1 2 3 4\n", kSquare);
    expect_read("a.obj", kMark + "# a comment\n" + kObjPoints + "f 1 2 3\n", kOneTriangle);
    expect_read("a.ply", kMark + ply(kFour + kOneFace, kPoints + "4 0 1 2 3\n"), kSquare);
    expect_read("a.off", kMark + kOff, kSquare);
    expect_read("a.stl", kMark + kStl, kOneTriangle);
}

TEST(MeshText, Utf16IsNamed) {
    for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
             {"a.obj", kObjPoints + "f 1 2 3\n"},
             {"a.ply", ply(kFour + kOneFace, kPoints + "4 0 1 2 3\n")},
             {"a.off", kOff},
             {"a.stl", kStl}}) {
        for (const bool big_endian : {false, true}) {
            for (const bool with_mark : {false, true}) {
                expect_refused(
                    name, utf16(text, big_endian, with_mark), "is UTF-16 text; save it as UTF-8");
            }
        }
    }
    expect_refused("a.obj", std::string("\xFF\xFE\0\0v\0\0\0", 8), "is UTF-32 text");
    expect_refused("a.gltf", utf16("{\"asset\": {}}", false, true), "it is UTF-16 text");
}

TEST(MeshText, LinesEndInAnyOfThreeWays) {
    for (const char* end : {"\n", "\r", "\r\n"}) {
        expect_read("a.obj", with_line_ends(kObjPoints + "f 1 2 3 4\n", end), kSquare);
        expect_read(
            "a.ply", with_line_ends(ply(kFour + kOneFace, kPoints + "4 0 1 2 3\n"), end), kSquare);
        expect_read("a.off", with_line_ends(kOff, end), kSquare);
        expect_read("a.stl", with_line_ends(kStl, end), kOneTriangle);
    }
    expect_read("a.obj", kObjPoints + "f 1 2 3 4", kSquare);  // none at the end
}

TEST(MeshText, LineNumbersCountEveryLineEndOnce) {
    for (const char* end : {"\n", "\r", "\r\n"}) {
        expect_refused("a.obj", with_line_ends("\n\n" + kObjPoints + "f 1 2 9\n", end), "line 7:");
    }
}

TEST(ObjText, LinesGoOnAfterABackslash) {
    expect_read("a.obj", kObjPoints + "f 1 2 \\ \n3 4\n", kSquare);
    expect_read("a.obj", kObjPoints + "f 1 2\\\t\r\n3 \\\n 4\n", kSquare);
    expect_read("a.obj", "v 0 0 \\  \n0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", kOneTriangle);
    expect_read("a.obj", kObjPoints + "f 1 2 3 \\", kOneTriangle);  // nothing follows
}

TEST(ObjText, CommentsDoNotGoOn) {
    expect_read("a.obj", "# C:\\models\\\n" + kObjPoints + "f 1 2 3\n", kOneTriangle);
}

TEST(ObjText, FacesMayStandBeforeTheirVertices) {
    expect_read("a.obj", "f 1 2 3 4\n" + kObjPoints, kSquare);
    expect_read("a.obj",
                "f 1 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\n",
                {{kA, kC, kD}, {kA, kB, kC}});
    expect_refused("a.obj", "f 1 2 5\n" + kObjPoints, "line 1: vertex index 5 is not in 1..4");
    expect_refused("a.obj", "f -1 2 3\n" + kObjPoints, "line 1: vertex index -1 is not in 1..0");
}

TEST(ObjText, TheOlderWordForAFaceIsKnown) {
    expect_read("a.obj", kObjPoints + "fo 1 2 3\n", kOneTriangle);
}

TEST(ObjText, WhatIsNoSurfaceIsTold) {
    expect_warned("a.obj",
                  kObjPoints + "f 1 2\nf 1 2 3\nf 4\n",
                  kOneTriangle,
                  "2 faces of fewer than three corners are left out, the first at line 5");
    expect_warned("a.obj",
                  kObjPoints + "f 1 2 3\nsurf 0 1 0 1 1 2 3 4\n",
                  kOneTriangle,
                  "1 free-form surfaces are left out, the first at line 6");
}

TEST(MeshText, VerticesThatNoFaceUsesMayHoldAnything) {
    expect_read("a.obj", "v nan nan nan\n" + kObjPoints + "v 1e99 0 0\nf 2 3 4\n", kOneTriangle);
    expect_read(
        "a.off", "OFF\n5 1 0\n1.#QNAN -1.#IND 1.#INF\n" + kPoints + "3 1 2 3\n", kOneTriangle);
    expect_read(
        "a.ply",
        ply("element vertex 5\nproperty float x\nproperty float y\nproperty float z\n" + kOneFace,
            kPoints + "-nan inf 0\n4 0 1 2 3\n"),
        kSquare);
    expect_refused("a.obj", "v nan 0 0\n" + kObjPoints + "f 1 2 3\n", "vertex 0 is not a number");
    expect_refused(
        "a.off", "OFF\n5 1 0\n" + kPoints + "1.#QNAN 0 0\n3 1 2 4\n", "vertex 4 is not a number");
}

TEST(MeshText, UnusedVerticesAreDroppedAndTheOthersKeepTheirOrder) {
    const test::TemporaryFolder folder;
    const LoadedScene loaded =
        load_scene(folder.file("a.obj", "v 9 9 9\n" + kObjPoints + "v 8 8 8\nf 3 2 5\n"));
    EXPECT_EQ(loaded.scene.mesh.positions_at(0.0), (std::vector<Vec3>{kA, kB, kD}));
    EXPECT_EQ(loaded.scene.mesh.triangles(), (std::vector<geometry::Triangle>{{1, 0, 2}}));
}

TEST(MeshText, NumbersTooSmallForADoubleAreZero) {
    expect_read("a.obj", "v 0 1e-400 -1e-999\nv 1 4e-324 0\nv 1 1 1e-91\nf 1 2 3\n", kOneTriangle);
    expect_refused("a.obj", "v 1e400 0 0\n" + kObjPoints + "f 1 2 3\n", "needs three numbers");
    EXPECT_EQ(to_number("1e-400"), 0.0);
    EXPECT_EQ(to_number("-2.5e-999"), 0.0);
    EXPECT_FALSE(to_number("1e400"));
    EXPECT_FALSE(to_number("xe-400"));
    EXPECT_FALSE(to_number("1e-4x0"));
    EXPECT_TRUE(std::isnan(*to_number("-1.#IND")));
}

TEST(PlyText, ElementsStandInAnyOrder) {
    expect_read("a.ply", ply(kOneFace + kFour, "4 0 1 2 3\n" + kPoints), kSquare);
    expect_read("a.ply",
                ply("element edge 1\nproperty int vertex1\nproperty int vertex2\n" + kOneFace +
                        "element camera 1\nproperty float fov\n" + kFour,
                    "0 1\n3 0 1 2\n60\n" + kPoints),
                kOneTriangle);
    expect_refused("a.ply",
                   ply(kOneFace + kFour, "4 0 1 2 4\n" + kPoints),
                   "face 0: vertex index 4 is not in 0..3");
}

TEST(PlyText, ValuesThatTheHeaderDoesNotNameAreLeftOutWithAWarning) {
    expect_warned("a.ply",
                  ply(kFour + kOneFace, "0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3\n"),
                  kSquare,
                  "4 lines of the element \"vertex\" hold more values than the header names, the "
                  "first is line 10");
    expect_warned("a.ply",
                  ply(kFour + "element face 2\nproperty list uchar int vertex_indices\n",
                      kPoints + "3 0 1 2 0\n3 0 2 3 0\n"),
                  kSquare,
                  "2 lines of the element \"face\"");
    expect_warned("a.ply",
                  ply(kFour + "element face 2\nproperty list uchar int vertex_indices\n",
                      kPoints + "3 0 1 2 1 1\n\n3 0 2 3\n"),
                  kSquare,
                  "1 lines of the element \"face\"");
}

TEST(PlyText, WhatIsLeftOverIsRefused) {
    expect_refused("a.ply",
                   ply(kFour + kOneFace, kPoints + "4 0 1 2 3\n3 0 1 2\n"),
                   "line 15: \"3 0 1 2\" follows the last element that the header counts");
    expect_refused(
        "a.off", kOff + "\n# a comment\n3 0 1 2\n", "line 10: \"3 0 1 2\" follows the last face");
}

TEST(PlyText, LinesBrokenElsewhereAreReadAsOneStream) {
    expect_read("a.ply", ply(kFour + kOneFace, "0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3\n"), kSquare);
    expect_read(
        "a.ply", ply(kFour + kOneFace, "0 0 0\n1 0\n0\n1 1 0\n0 1 0\n4 0 1\n2 3\n"), kSquare);
    expect_read("a.ply", ply(kFour + kOneFace, "0 0 0 1 0 0\n1 1 0 0 1 0\n3 0 1 2"), kOneTriangle);
    expect_refused("a.ply",
                   ply(kFour + kOneFace, "0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3 4\n"),
                   "has \"4\" after the last element");
    expect_refused("a.ply",
                   ply(kFour + kOneFace, "0 0 0\n1 0 0\n1 1 0\n0 1\n4 0 1 2 3\n"),
                   "line 13 is too short for a \"vertex\"");
    expect_refused("a.ply",
                   ply(kFour + "element face 2\nproperty list uchar int vertex_indices\n",
                       "0 0 0 1 0 0 1 1 0 0 1 0 2 0 1 3 1 2 3"),
                   "has faces of fewer than three corners");
}

TEST(PlyText, BytesAfterABinaryBodyAreTold) {
    std::string body;
    for (const float number : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F}) {
        body.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
    body += '\3';
    for (const std::int32_t index : {0, 1, 2}) {
        body.append(reinterpret_cast<const char*>(&index), sizeof index);
    }
    const std::string header =
        "ply\nformat binary_little_endian 1.0\n" + kFour + kOneFace + "end_header\n";
    expect_read("a.ply", header + body, kOneTriangle);
    expect_read("a.ply", with_line_ends(header, "\r\n") + body, kOneTriangle);
    expect_read("a.ply", header.substr(0, header.size() - 1) + "\r\n" + body, kOneTriangle);
    expect_warned("a.ply", header + body + "xyz", kOneTriangle, "3 bytes after the last element");
}

TEST(StlText, SolidMayBeNamelessOrInCapitalsOrAfterBlankLines) {
    expect_read("a.stl", "solid\n" + kFacet + "endsolid\n", kOneTriangle);
    expect_read("a.stl", "solid\r\n" + with_line_ends(kFacet, "\r\n") + "endsolid", kOneTriangle);
    expect_read("a.stl",
                "SOLID A\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\n"
                "VERTEX 1 1 0\nENDLOOP\nENDFACET\nENDSOLID A\n",
                kOneTriangle);
    expect_read("a.stl", "\n  \n\t" + kStl, kOneTriangle);
    expect_read("a.stl", "Solid facet normal vertex\n" + kFacet + "EndSolid\n", kOneTriangle);
}

TEST(StlText, KeywordsMayBeCutAndLinesJoined) {
    expect_read("a.stl",
                "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                "vertex 1 1 0\nend loop\nend facet\nend solid a\n",
                kOneTriangle);
    expect_read("a.stl",
                "solid some name facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 "
                "vertex 1 1 0 endloop endfacet endsolid some name",
                kOneTriangle);
    expect_read("a.stl",
                "solid facet normal nan nan nan outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 "
                "endloop endfacet endsolid x solid b facet normal 0 0 1 outer loop vertex 0 0 0 "
                "vertex 1 1 0 vertex 0 1 0 endloop endfacet endsolid",
                kSquare);
}

TEST(StlText, OtherLinesAreToldAndOtherFacetsRefused) {
    expect_warned("a.stl",
                  "solid a\ncolor 1 0 0\n" + kFacet + "endsolid a\nmade by a program\n",
                  kOneTriangle,
                  "2 lines that STL does not know are left out, the first is line 2");
    expect_refused("a.stl",
                   "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                   "vertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
                   "line 7: a facet needs three vertices, this is the fourth");
    expect_refused("a.stl",
                   "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\n",
                   "line 4: a facet needs three vertices of three numbers");
    expect_refused("a.stl", "solid a\n" + kFacet, "does not end with endsolid, line 8 is the last");
    expect_refused("a.stl",
                   "<html>" + std::string(100, ' ') + "</html>",
                   "is text that does not begin with solid");
}

TEST(OffText, CountsMayBeGluedToTheKeyword) {
    expect_read("a.off", "OFF4 1 0\n" + kPoints + "4 0 1 2 3\n", kSquare);
    expect_read(
        "a.off", "COFF4 1 0\n0 0 0 9 9 9 1\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 7\n", kOneTriangle);
    expect_read("a.off", "# ModelNet\n\nOFF4 1\n" + kPoints + "4 0 1 2 3\n", kSquare);
    expect_refused("a.off", "4OFF4 1 0\n", "does not begin with OFF");
    expect_refused("a.off", "4 1 0\n" + kPoints, "line 1 holds numbers; put a line OFF");
    expect_refused("a.off", "OFF 4 1 0 0 0 0 1 0 0\n", "line 1: more than the numbers of");
}

}  // namespace
}  // namespace earshot::io
