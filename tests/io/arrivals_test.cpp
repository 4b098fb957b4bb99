// SPDX-License-Identifier: MIT
#include "earshot/io/arrivals.h"

#include "earshot/propagation/room_shapes.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace earshot::io {
namespace {

using Surfaces = std::vector<std::string>;

propagation::Scene room() {
    propagation::Scene scene = propagation::shoebox_room({5, 3, 4});
    scene.sources.push_back({.name = "s"});
    scene.listeners.push_back({.name = "a"});
    scene.listeners.push_back({.name = "b"});
    return scene;
}

class ArrivalTables : public testing::Test {
protected:
    ArrivalTable read(const std::string& text) {
        std::ofstream(file_) << text;
        return read_arrivals(file_, room());
    }
    std::string error_of(const std::string& text) {
        try {
            read(text);
        } catch (const Error& error) {
            return error.line();
        }
        return "";
    }

private:
    test::TemporaryFolder folder_;
    std::filesystem::path file_ = folder_.path() / "arrivals.csv";
};

TEST_F(ArrivalTables, GiveWhatTheyKnowOfSurfaces) {
    const ArrivalTable table = read(
        "source,listener,surfaces,time\ns,a,direct,0.01\n\ns,b, floor > east ,0.02\n"
        "s,b,,3e-2\n");
    ASSERT_EQ(table.arrivals.size(), 3U);
    EXPECT_TRUE(table.warnings.empty());
    EXPECT_EQ(table.arrivals[0].surfaces, Surfaces{});
    EXPECT_EQ(table.arrivals[0].time, 0.01);
    EXPECT_EQ(table.arrivals[1].listener, 1U);
    EXPECT_EQ(table.arrivals[1].surfaces, (Surfaces{"floor", "east"}));
    EXPECT_FALSE(table.arrivals[2].surfaces);
    EXPECT_EQ(table.arrivals[2].time, 0.03);
    EXPECT_FALSE(read("s,a,0.5").arrivals[0].surfaces);
}

TEST_F(ArrivalTables, LeaveOutPairsThatTheSceneDoesNotHave) {
    const ArrivalTable table = read("s,a,0.01\ns,c,0.01\ns,c,0.02\n");
    EXPECT_EQ(table.arrivals.size(), 1U);
    ASSERT_EQ(table.warnings.size(), 1U);
    EXPECT_EQ(table.warnings[0].what, "the scene has no pair s, c; 2 arrivals left out");
}

TEST_F(ArrivalTables, RefuseLinesThatAreNoArrivals) {
    EXPECT_NE(error_of("s,a,0.01\ns,a\n").find("line 2 has 2 columns"), std::string::npos);
    EXPECT_NE(error_of("s,a,direct,soon\n1,2,3\n").find("of the scene"), std::string::npos);
    EXPECT_NE(error_of("s,a,0.1\ns,a,direct,soon\n").find("has the time 'soon'"),
              std::string::npos);
    EXPECT_NE(error_of("s,a,-0.1\n").find("has the time '-0.1'"), std::string::npos);
    EXPECT_NE(error_of("s,a,nan\n").find("has the time 'nan'"), std::string::npos);
    EXPECT_NE(error_of("s,a,floor>roof,0.1\n").find("names the surface 'roof'"), std::string::npos);
    EXPECT_NE(error_of("\n").find("no arrival"), std::string::npos);
}

}  // namespace
}  // namespace earshot::io
