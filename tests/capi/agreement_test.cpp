// SPDX-License-Identifier: MIT
//
// What the C interface gives is what the program writes, to the byte, and what the library answers.

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/whole_file.h"
#include "earshot/visibility/line_of_sight.h"

#include <gtest/gtest.h>

#include "earshot.h"
#include "support/dice.h"
#include "support/earshot_program.h"
#include "support/temporary_folder.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace earshot {
namespace {

void expect_ok(es_status status) {
    ASSERT_EQ(status, ES_OK) << es_error_message();
}

std::string bytes_of(const std::filesystem::path& file) {
    return io::read_whole_file(file);
}

/// A simulation both ways.
struct SimulatedCase {
    std::string scene;
    std::string arguments;
    es_simulation_options options{};
};

es_simulation_options defaults() {
    es_simulation_options options;
    expect_ok(es_simulation_options_init(&options, sizeof options));
    options.order = 2;
    options.rays = 4096;
    options.rays_error = 0.0;
    options.histograms = 1;
    options.sensitivity = 1;
    return options;
}

class Agreement : public testing::Test {
protected:
    void expect_same_files(const SimulatedCase& run) {
        const std::string file = test::source_file(run.scene).string();
        const std::string command =
            test::earshot_program() + " ir " + file + " -o " + (folder_ / "program").string() +
            " --quiet --histograms --sensitivity --order 2 --rays 4096 " + run.arguments;
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
        es_scene scene = 0;
        es_result result = 0;
        expect_ok(es_scene_load(file.c_str(), nullptr, &scene));
        expect_ok(es_simulate(scene, &run.options, &result));
        const char* documents[] = {
            "paths.json", "metrics.json", "histograms.json", "sensitivity.json"};
        for (std::int32_t document = ES_PATHS_JSON; document <= ES_SENSITIVITY_JSON; ++document) {
            const std::filesystem::path mine = folder_ / documents[document];
            expect_ok(es_result_write(result, document, mine.c_str()));
            EXPECT_EQ(bytes_of(mine), bytes_of(folder_ / "program" / documents[document]))
                << run.scene << ", " << documents[document];
        }
        expect_same_sounds(run, scene, result);
        if (run.options.sofa != 0) {
            const std::filesystem::path mine = folder_ / "responses.sofa";
            expect_ok(es_results_write_sofa(&result, 1, mine.c_str()));
            EXPECT_EQ(bytes_of(mine), bytes_of(folder_ / "program" / "responses.sofa"))
                << run.scene;
        }
        expect_ok(es_release(result));
        expect_ok(es_release(scene));
    }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

private:
    void expect_same_sounds(const SimulatedCase& run, es_scene scene, es_result result) {
        es_result_info info{};
        info.struct_size = sizeof info;
        expect_ok(es_result_get_info(result, &info));
        for (std::size_t source = 0; source < info.sources; ++source) {
            for (std::size_t listener = 0; listener < info.listeners; ++listener) {
                const char *from = nullptr, *to = nullptr;
                es_sound sound = 0;
                expect_ok(es_scene_item_name(scene, ES_SOURCES, source, &from));
                expect_ok(es_scene_item_name(scene, ES_LISTENERS, listener, &to));
                const std::string name = std::string(from) + "__" + to + ".wav";
                expect_ok(es_result_sound(result, source, listener, &sound));
                expect_ok(es_sound_write(sound, (folder_ / name).c_str(), nullptr));
                expect_ok(es_release(sound));
                EXPECT_EQ(bytes_of(folder_ / name), bytes_of(folder_ / "program" / name))
                    << run.scene << ", " << name;
            }
        }
    }

    test::TemporaryFolder temporary_;
    std::filesystem::path folder_ = temporary_.path();
};

TEST_F(Agreement, MonoResponsesAreThoseOfTheProgram) {
    expect_same_files({"scenes/lroom.gltf", "", defaults()});
}

TEST_F(Agreement, BinauralResponsesAreThoseOfTheProgram) {
    SimulatedCase run = {
        "scenes/coupled_rooms.gltf", "--format binaural --transmission --sofa", defaults()};
    run.options.format = ES_FORMAT_BINAURAL;
    run.options.transmission = 1;
    run.options.sofa = 1;
    expect_same_files(run);
}

TEST_F(Agreement, DiffractedPathsAreThoseOfTheProgram) {
    SimulatedCase run = {
        "scenes/door.gltf", "--diffraction 1 --min-diffraction-level -25 --time 1.5", defaults()};
    run.options.diffraction = 1;
    run.options.min_diffraction_level_db = -25.0;
    run.options.time = 1.5;
    expect_same_files(run);
}

// The module that reads SOFA files is loaded for it.
TEST_F(Agreement, AnHrirSetOfAFileIsThatOfTheProgram) {
    const char* file = "/usr/share/libmysofa/MIT_KEMAR_normal_pinna.sofa";
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << file << " is not there (package libmysofa1)";
    }
    SimulatedCase run = {
        "scenes/shoebox.gltf", std::string("--format binaural --hrtf ") + file, defaults()};
    run.options.format = ES_FORMAT_BINAURAL;
    run.options.hrtf_file = file;
    expect_same_files(run);
    run.arguments += " --hrtf-raw";
    run.options.hrtf_raw = 1;
    expect_same_files(run);
}

TEST_F(Agreement, OptionsMeanWhatTheyMeanToTheProgram) {
    const double noise[7] = {50.0, 45.0, 40.0, 35.0, 30.0, 25.0, 20.0};
    SimulatedCase run = {
        "scenes/door.gltf",
        "--format ambisonic:2 --time 1.5 --seed 7 --bands third --sample-rate 16000 "
        "--temperature 5 --humidity 20 --pressure 90 --length 0.4 --max-length 40 "
        "--min-level -70 --mode sampled --noise 50,45,40,35,30,25,20 --speech-level raised",
        defaults()};
    run.options.format = ES_FORMAT_AMBISONIC;
    run.options.ambisonic_order = 2;
    run.options.time = 1.5;
    run.options.seed = 7;
    run.options.bands = ES_BANDS_THIRD;
    run.options.sample_rate = 16000.0;
    run.options.temperature_c = 5.0;
    run.options.humidity_percent = 20.0;
    run.options.pressure_kpa = 90.0;
    run.options.length = 0.4;
    run.options.max_length = 40.0;
    run.options.min_level_db = -70.0;
    run.options.mode = ES_MODE_SAMPLED;
    run.options.speech = 1;
    run.options.speech_level_db = 66.0;
    run.options.noise_db = noise;
    expect_same_files(run);
}

// One file for all instants, as of a sequence.
TEST_F(Agreement, ASofaFileOfSeveralInstantsIsThatOfTheProgram) {
    const std::string file = test::source_file("scenes/door.gltf").string();
    const std::string command = test::earshot_program() + " ir " + file + " -o " + path("program") +
                                " --quiet --order 1 --rays 0 --frames 0:2:1 --sofa "
                                "--format ambisonic:1 --length 0.1";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    es_simulation_options options = defaults();
    options.order = 1;
    options.rays = 0;
    options.length = 0.1;
    options.format = ES_FORMAT_AMBISONIC;
    options.sofa = 1;
    es_scene scene = 0;
    es_simulator simulator = 0;
    std::vector<es_result> results(3);
    expect_ok(es_scene_load(file.c_str(), nullptr, &scene));
    expect_ok(es_simulator_create(scene, &options, &simulator));
    for (std::size_t i = 0; i < results.size(); ++i) {
        expect_ok(es_simulator_run(simulator, static_cast<double>(i), &results[i]));
    }
    expect_ok(es_results_write_sofa(results.data(), results.size(), path("mine.sofa").c_str()));
    EXPECT_EQ(bytes_of(path("mine.sofa")), bytes_of(path("program") + "/responses.sofa"));
    for (const std::uint64_t handle : results) {
        expect_ok(es_release(handle));
    }
    expect_ok(es_release(simulator));
    expect_ok(es_release(scene));
}

/// Visible sets both ways.
struct SetsCase {
    std::string scene;
    std::string arguments;
    es_visible_sets_options options{};
};

TEST_F(Agreement, PicturesOfMapsAreThoseOfTheProgram) {
    const std::string file = test::source_file("scenes/shoebox.gltf").string();
    const std::string command =
        test::earshot_program() + " map " + file +
        " --rect 1,-3,3,-1 --height 1.2 --step 0.5 --coarse-step 0.5 --metric g --rays 0 "
        "--order 2 --limit g=20 --quiet -o " +
        path("program.svg") + " -o " + path("program.png");
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    es_scene scene = 0;
    expect_ok(es_scene_load(file.c_str(), nullptr, &scene));
    es_simulation_options simulation = defaults();
    simulation.rays = 0;
    es_map_options options;
    expect_ok(es_map_options_init(&options, sizeof options));
    const double rectangle[] = {1.0, -3.0, 3.0, -1.0};
    std::copy(rectangle, rectangle + 4, options.rectangle);
    options.step = options.coarse_step = 0.5;
    options.metrics = "g";
    es_metric_map map = 0;
    expect_ok(es_map_create(scene, &simulation, &options, &map));
    for (const char* const suffix : {".svg", ".png"}) {
        const std::string mine = path(std::string("mine") + suffix);
        expect_ok(es_map_draw(map, 0, 0, scene, 20.0, mine.c_str()));
        EXPECT_TRUE(bytes_of(mine) == bytes_of(path(std::string("program") + suffix))) << suffix;
    }
    expect_ok(es_release(map));
    expect_ok(es_release(scene));
}

class SetsAgreement : public Agreement {
protected:
    static es_visible_sets_options sets_defaults() {
        es_visible_sets_options options;
        expect_ok(es_visible_sets_options_init(&options, sizeof options));
        options.rays = 60000;
        return options;
    }

    void expect_same_sets(const SetsCase& run) {
        const std::string file = test::source_file(run.scene).string();
        const std::string command = test::earshot_program() + " pvs build " + file + " -o " +
                                    path("program.pvs") + " --quiet --rays 60000 " + run.arguments;
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
        es_scene scene = 0;
        es_visible_sets sets = 0;
        expect_ok(es_scene_load(file.c_str(), nullptr, &scene));
        expect_ok(es_visible_sets_build(scene, &run.options, &sets));
        expect_ok(es_visible_sets_write(sets, path("mine.pvs").c_str()));
        EXPECT_EQ(bytes_of(path("mine.pvs")), bytes_of(path("program.pvs"))) << run.arguments;
        expect_ok(es_release(sets));
        expect_ok(es_release(scene));
    }
};

TEST_F(SetsAgreement, OneCellIsThatOfTheProgram) {
    const double region[6] = {1.0, 1.0, 1.0, 2.0, 1.5, 2.0};
    SetsCase run = {"scenes/coupled_rooms.gltf",
                    "--region 1,1,1:2,1.5,2 --seed 5 --until 2 --validation 3000",
                    sets_defaults()};
    run.options.region = region;
    run.options.seed = 5;
    run.options.until = 2;
    run.options.validation_rays = 3000;
    expect_same_sets(run);
}

TEST_F(SetsAgreement, CellsAreThoseOfTheProgram) {
    SetsCase run = {"scenes/door.gltf",
                    "--cells 5 --segments 9000 --objects 3 --skip-solids --time 1 --until 3",
                    sets_defaults()};
    run.options.cells = 5;
    run.options.segments = 9000;
    run.options.triangles_per_object = 3;
    run.options.skip_solids = 1;
    run.options.time = 1.0;
    run.options.until = 3;
    expect_same_sets(run);
}

TEST_F(SetsAgreement, AGridIsThatOfTheProgramForAnyThreads) {
    const std::uint32_t grid[3] = {2, 1, 3};
    SetsCase run = {"scenes/coupled_rooms.gltf", "--grid 2,1,3 --threads 2", sets_defaults()};
    run.options.grid = grid;
    run.options.threads = 1;
    expect_same_sets(run);
}

TEST(CapiSight, AnswersAreThoseOfTheLibrary) {
    const std::string file = test::source_file("scenes/concert_hall.gltf").string();
    const propagation::Scene scene = io::load_scene(file).scene;
    const std::vector<geometry::Vec3> positions = scene.mesh.positions_at(0.0);
    const geometry::MeshView mesh{positions, scene.mesh.triangles()};
    const bvh::DeformableBvh tree(mesh);
    support::Dice dice(3);
    std::vector<geometry::Segment> segments(20000);
    std::vector<double> from, to;
    for (geometry::Segment& segment : segments) {
        for (geometry::Vec3* end : {&segment.from, &segment.to}) {
            *end = {dice.between(-10.0, 10.0), dice.between(0.0, 15.0), dice.between(-40.0, 2.0)};
            auto& ends = end == &segment.from ? from : to;
            ends.insert(ends.end(), {end->x, end->y, end->z});
        }
    }
    es_scene room = 0;
    es_bvh bvh = 0;
    std::vector<std::uint8_t> visible(segments.size());
    std::vector<std::uint32_t> triangles(segments.size());
    std::vector<double> t(segments.size());
    expect_ok(es_scene_load(file.c_str(), nullptr, &room));
    expect_ok(es_bvh_create_from_scene(room, 0.0, ES_BUILDER_FAST, 1, &bvh));
    expect_ok(es_bvh_visible(bvh, from.data(), to.data(), segments.size(), 2, visible.data()));
    expect_ok(es_bvh_first_blockers(
        bvh, from.data(), to.data(), segments.size(), 2, triangles.data(), t.data()));
    EXPECT_EQ(visible, visibility::visible(tree.view(), segments));
    const auto blockers = visibility::first_blockers(tree.view(), segments);
    for (std::size_t i = 0; i < segments.size(); ++i) {
        ASSERT_EQ(triangles[i], blockers[i] ? blockers[i]->triangle : ES_NONE) << i;
        ASSERT_TRUE(!blockers[i] || t[i] == blockers[i]->t) << i;
    }
    expect_ok(es_release(bvh));
    expect_ok(es_release(room));
}

}  // namespace
}  // namespace earshot
