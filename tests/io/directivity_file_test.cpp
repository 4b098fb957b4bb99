// SPDX-License-Identifier: MIT
#include "earshot/io/directivity_file.h"

#include "earshot/base/error.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"
#include <cmath>
#include <string>

namespace earshot::io {
namespace {

class DirectivityFile : public testing::Test {
protected:
    propagation::Directivity read(const std::string& text) const {
        return read_directivity(folder_.file("directivity.csv", text));
    }
    std::string fault_of(const std::string& text) const {
        try {
            read(text);
        } catch (const Error& error) {
            return error.line();
        }
        return "none";
    }

    const test::TemporaryFolder folder_;
};

TEST_F(DirectivityFile, HoldsADirectionPerLineInAnyOrder) {
    const auto directivity =
        read("azimuth, elevation, 500, 2000\r\n180,0,-12,-24\r\n0,0,0,0\r\n\r\n");
    const auto behind = directivity.pressure(audio::Bands::octaves(), {-1, 0, 0});
    EXPECT_NEAR(20.0 * std::log10(behind[0]), -12.0, 1e-9);
    EXPECT_NEAR(20.0 * std::log10(behind[9]), -24.0, 1e-9);
    EXPECT_NEAR(directivity.pressure(audio::Bands::octaves(), {1, 0, 0})[5], 1.0, 1e-12);
}

TEST_F(DirectivityFile, FaultsNameTheLine) {
    EXPECT_NE(fault_of("azimuth,elevation,1000\n0,0,zero\n").find("line 2"), std::string::npos);
    EXPECT_NE(fault_of("azimuth,elevation,1000\n0,0\n").find("line 2"), std::string::npos);
    EXPECT_NE(fault_of("angle,elevation,1000\n").find("line 1"), std::string::npos);
    EXPECT_NE(fault_of("azimuth,elevation,1000\n0,0,1\n0,0,2\n").find("line 3"), std::string::npos);
    EXPECT_NE(fault_of("azimuth,elevation,1000\n0,0,1\n90,10,2\n").find("every azimuth"),
              std::string::npos);
    EXPECT_NE(fault_of("").find("every azimuth"), std::string::npos);
    EXPECT_NE(fault_of("azimuth,elevation,1000\n400,0,1\n").find("azimuths"), std::string::npos);
}

TEST(DirectivityNamed, IsOfTheFamilyOrAFile) {
    EXPECT_TRUE(directivity_named("omni", "", "x").is_omnidirectional());
    EXPECT_FALSE(directivity_named("cardioid", "", "x").is_omnidirectional());
    EXPECT_THROW(directivity_named("heart", "", "x"), Error);
    EXPECT_THROW(directivity_named("no_such_file.csv", "/", "x"), Error);
}

}  // namespace
}  // namespace earshot::io
