// SPDX-License-Identifier: MIT
#include "earshot/io/internal/stated_unit.h"

#include "earshot/io/scene_file.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <utility>

namespace earshot::io {
namespace {

std::string unit_of(std::string_view comment) {
    const auto stated = unit_in_comment(comment);
    return stated ? stated->unit : "none";
}

TEST(StatedUnit, IsFoundAfterTheWordUnit) {
    EXPECT_EQ(unit_of("# File units = inches"), "in");  // SketchUp
    EXPECT_EQ(unit_of("# File units = meters"), "m");
    EXPECT_EQ(unit_of("units: mm"), "mm");
    EXPECT_EQ(unit_of("UNITS=mm"), "mm");
    EXPECT_EQ(unit_of("Unit is centimetre"), "cm");
    EXPECT_EQ(unit_of("# all units are in feet"), "ft");
    EXPECT_EQ(unit_of("# Units: in"), "in");
    EXPECT_EQ(unit_of("# length unit (m)"), "m");
}

TEST(StatedUnit, IsNotGuessed) {
    for (const char* comment : {"# Blender 4.1",
                                "# www.meters.example",
                                "# a united family of m",
                                "# 12 inches of rain",
                                "# units: furlongs",
                                "# unit cube, edges in m",
                                "",
                                "# unit"}) {
        EXPECT_EQ(unit_of(comment), "none") << comment;
    }
}

TEST(StatedUnit, OfAFileIsToldUnlessItIsMetres) {
    const test::TemporaryFolder folder;
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string ply =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    const std::string facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        "endfacet\nendsolid\n";
    const auto warnings_of = [&](const std::string& name, const std::string& bytes) {
        Warnings warnings = load_scene(folder.file(name, bytes)).warnings;
        std::erase_if(warnings, [](const Warning& warning) {
            return warning.what.find("acoustic") != std::string::npos;
        });
        return warnings;
    };
    for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
             {"a.obj", "# File units = inches\n" + obj},
             {"a.ply", "ply\nformat ascii 1.0\ncomment units: inches\n" + ply},
             {"a.ply", "ply\nformat ascii 1.0\nobj_info unit inches\n" + ply},
             {"a.stl", "solid part units=inches\n" + facet}}) {
        const Warnings warnings = warnings_of(name, bytes);
        ASSERT_EQ(warnings.size(), 1U) << bytes;
        EXPECT_NE(warnings[0].what.find("inches\", but its coordinates are taken as metres"),
                  std::string::npos)
            << warnings[0].what;
    }
    EXPECT_TRUE(warnings_of("a.obj", "# File units = meters\n" + obj).empty());
    EXPECT_TRUE(warnings_of("a.obj", obj).empty());
}

}  // namespace
}  // namespace earshot::io
