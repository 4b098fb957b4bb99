// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/earshot_program.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

namespace earshot::test {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;  // name to bytes

/// Runs a command that writes into a folder, or a file in it where its last word is the file's
/// name, and returns all that it wrote.
Files output_of(const std::vector<std::string>& job,
                const std::vector<std::string>& extra,
                const RunOptions& options = {}) {
    const TemporaryFolder temporary;
    const fs::path folder = temporary.path() / "out";
    std::vector<std::string> command = {earshot_program()};
    command.insert(command.end(), job.begin(), job.end());
    if (job.front() == "ir") {
        command.insert(command.end(), {"-o", folder.string(), "--quiet"});
    } else {
        fs::create_directories(folder);
        command.back() = (folder / job.back()).string();
    }
    command.insert(command.end(), extra.begin(), extra.end());
    const RunResult result = run_program(command, options);
    EXPECT_EQ(result.status, 0) << result.err;
    Files files;
    for (const auto& entry : fs::directory_iterator(folder)) {
        std::ifstream stream(entry.path(), std::ios::binary);
        files[entry.path().filename().string()] = {std::istreambuf_iterator<char>(stream), {}};
    }
    return files;
}

void expect_same(const Files& expected, const Files& files, const std::string& what) {
    ASSERT_EQ(expected.size(), files.size()) << what;
    for (const auto& [name, bytes] : expected) {
        ASSERT_EQ(files.count(name), 1U) << what;
        EXPECT_TRUE(files.at(name) == bytes) << name << " differs with " << what;
    }
}

/// Everything a run may differ in without its results differing.
void expect_determinism(const std::vector<std::string>& job) {
    const Files expected = output_of(job, {});
    ASSERT_GE(expected.size(), job.front() == "ir" ? 3U : 1U);
    expect_same(expected, output_of(job, {}), "a second run");
    for (const char* threads : {"1", "2", "8"}) {
        expect_same(
            expected, output_of(job, {"--threads", threads}), std::string(threads) + " threads");
    }
    for (const std::string& target : simd_targets()) {
        expect_same(expected, output_of(job, {"--simd", target}), target);
    }
    const RunOptions masked = {
        .environment = {{"GLIBC_TUNABLES",
                         "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F,-AVX2_Usable,-FMA_Usable"}}};
    expect_same(expected, output_of(job, {"--simd", "scalar"}, masked), "masked CPU features");
}

const std::string kScenes = test::source_file("scenes/").string();

TEST(OutputFiles, AreTheSameBytesForDiffractedSound) {
    expect_determinism(
        {"ir", kScenes + "lroom.gltf", "--order", "1", "--diffraction", "1", "--rays", "500"});
}

TEST(OutputFiles, AreTheSameBytesForSoundRoundTwoEdges) {
    expect_determinism({"ir",
                        kScenes + "coupled_rooms.gltf",
                        "--order",
                        "1",
                        "--diffraction",
                        "2",
                        "--rays",
                        "0",
                        "--length",
                        "0.3"});
}

TEST(OutputFiles, AreTheSameBytesForSoundRoundADoorThatOpens) {
    expect_determinism({"ir",
                        kScenes + "door.gltf",
                        "--order",
                        "1",
                        "--diffraction",
                        "1",
                        "--rays",
                        "0",
                        "--length",
                        "0.3",
                        "--frames",
                        "1:2:0.5"});
}

TEST(OutputFiles, AreTheSameBytesForARoom) {
    expect_determinism({"ir",
                        kScenes + "classroom.gltf",
                        "--order",
                        "2",
                        "--rays",
                        "2000",
                        "--format",
                        "binaural",
                        "--sofa",
                        "--length",
                        "0.5"});
}

// Derivatives and their standard errors too, of materials that scatter unlike in each band.
TEST(OutputFiles, AreTheSameBytesForSensitivity) {
    expect_determinism(
        {"ir", kScenes + "classroom.gltf", "--order", "2", "--rays", "4000", "--sensitivity"});
}

// Rays that start at the listener find what surfaces near it scatter.
TEST(OutputFiles, AreTheSameBytesForAListenerNearASurface) {
    expect_determinism({"ir",
                        kScenes + "classroom.gltf",
                        "--listener",
                        "floor=3.27,0.01,1.14",
                        "--order",
                        "1",
                        "--rays",
                        "1000",
                        "--histograms",
                        "--length",
                        "0.3"});
}

TEST(OutputFiles, AreTheSameBytesForAMovingScene) {
    expect_determinism({"ir",
                        kScenes + "curtain.gltf",
                        "--order",
                        "2",
                        "--rays",
                        "500",
                        "--length",
                        "0.3",
                        "--frames",
                        "0:0.6:0.3"});
}

TEST(OutputFiles, AreTheSameBytesForContacts) {
    for (const std::string kind : {"--self", "--discrete"}) {
        expect_determinism({"collide",
                            kScenes + "curtain.gltf",
                            kind,
                            "--frames",
                            "0:0.6:0.1",
                            "--quiet",
                            "-o",
                            "contacts.json"});
    }
}

TEST(OutputFiles, AreTheSameBytesForWhatAPointSees) {
    for (const std::string file : {"seen.json", "seen.csv"}) {
        expect_determinism({"visible",
                            kScenes + "classroom.gltf",
                            "--from",
                            "3.27,1.63,1.14",
                            "--resolution",
                            "3",
                            "--quiet",
                            "-o",
                            file});
    }
    for (const std::string colour : {"material", "depth"}) {
        expect_determinism({"visible",
                            kScenes + "classroom.gltf",
                            "--from",
                            "3.27,1.63,1.14",
                            "--resolution",
                            "10",
                            "--quiet",
                            "--colour",
                            colour,
                            "--image-size",
                            "256",
                            "--image",
                            "seen.png"});
    }
}

/// The paths of the pairs at an instant, as text.
std::vector<std::string> paths_at(const std::string& paths_json, double time) {
    const auto file = nlohmann::json::parse(paths_json);
    std::vector<std::string> pairs;
    for (const auto& pair : file["pairs"]) {
        if (pair["time"] == time) {
            pairs.push_back(pair.dump());
        }
    }
    return pairs;
}

/// The third instant of a sequence and that instant alone give the same sound and the same paths.
void expect_same_as_alone(const std::vector<std::string>& job,
                          const std::string& times,
                          double last) {
    const Files sequence = output_of(job, {"--frames", times});
    const Files alone = output_of(job, {"--time", std::to_string(last)});
    int compared = 0;
    for (const auto& [name, bytes] : alone) {
        if (name.ends_with(".wav")) {
            const std::string numbered = name.substr(0, name.size() - 4) + "__0002.wav";
            ASSERT_EQ(sequence.count(numbered), 1U) << numbered;
            EXPECT_TRUE(sequence.at(numbered) == bytes) << name;
            ++compared;
        }
    }
    EXPECT_GE(compared, 1);
    const auto expected = paths_at(alone.at("paths.json"), last);
    EXPECT_FALSE(expected.empty());
    EXPECT_TRUE(paths_at(sequence.at("paths.json"), last) == expected);
}

// A refitted hierarchy and a freshly built one.
TEST(OutputFiles, DoNotDependOnTheFramesBefore) {
    expect_same_as_alone(
        {"ir", kScenes + "curtain.gltf", "--order", "2", "--rays", "500", "--length", "0.3"},
        "0:0.6:0.3",
        0.6);
}

// The edges of a door that turns, and of a cloth whose folds make and end edges.
TEST(OutputFiles, DoNotDependOnTheFramesBeforeWhereSoundBends) {
    const std::vector<std::string> options = {
        "--diffraction", "1", "--rays", "0", "--length", "0.3", "--no-metrics"};
    const auto job_of = [&](const char* scene, const char* order) {
        std::vector<std::string> job = {"ir", kScenes + scene, "--order", order};
        job.insert(job.end(), options.begin(), options.end());
        return job;
    };
    expect_same_as_alone(job_of("door.gltf", "1"), "1:2:0.5", 2.0);
    expect_same_as_alone(job_of("curtain.gltf", "0"), "0:0.6:0.3", 0.6);
}

}  // namespace
}  // namespace earshot::test
