// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/values.h"
#include "earshot/collision/world.h"
#include "earshot/io/contacts.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

using collision::World;
using geometry::Triangle;
using geometry::Vec3;

constexpr const char* kFooter =
    "A scene's parts (primitives of a node) are the meshes 0, 1, ...; several files are poses of "
    "one\n"
    "mesh, and then it is tested against itself. Between two instants every vertex moves on a\n"
    "straight line. No contact is missed, and no time of impact is late.\n\n"
    "Examples:\n"
    "  earshot collide scenes/door.gltf --frames 0:2:0.1 -o contacts.json\n"
    "      what of the door meets the frame between 0 and 2 s\n"
    "  earshot collide cloth_00.ply cloth_01.ply cloth_02.ply -o contacts.csv\n"
    "      where cloth runs into itself, from file to file";

constexpr double kFramesPerSecond = 30.0;

/// Meshes by their vertices' and triangles' ranges, and where the vertices are.
struct Motion {
    std::vector<std::vector<Triangle>> triangles;  // per mesh, counting from its first vertex
    std::vector<std::size_t> first_vertex;         // per mesh, and the number of all
    std::vector<double> times;
    std::function<std::vector<Vec3>(std::size_t)> positions;  // at one of the times
};

struct Totals {
    std::size_t steps = 0, contacts = 0;
    collision::WorldStatistics statistics;
    double seconds = 0.0;
};

class CollideCommand : public Command {
public:
    explicit CollideCommand(CLI::App& program)
        : Command(program, "collide", "Contacts of meshes that move and deform") {
        app()
            .add_option("FILES", files_, "a scene, or poses of one mesh in their order")
            ->required();
        add_output("-o,--output", output_, "the file to write: .json, or .csv for a table")
            ->required();
        app().add_option("--frames",
                         frames_,
                         "instants A:B:STEP of a scene, seconds; default: all of its animation, 30 "
                         "in a second");
        app().add_option(
            "--animation", animation_, "name or number of the animation; default: the first");
        app().add_flag("--discrete",
                       discrete_,
                       "pairs of triangles that meet at each instant, instead of what touches "
                       "between them");
        app().add_flag("--self", within_, "meshes are tested against themselves too");
        add_number(app(),
                   "--min-separation",
                   options_.min_separation,
                   {0.0, 1e6},
                   "elements as near as this along every axis are in contact, metres");
        add_number(app(),
                   "--tolerance",
                   options_.tolerance,
                   {1e-12, 1e6},
                   "how much farther apart may count as nearer, with --min-separation, metres");
        app().footer(kFooter);
    }

    void run() override {
        if (files_.size() > 1) {
            check_options_of_poses();
        }
        override_simd_target(common().simd);
        Executor executor(static_cast<int>(common().threads));
        Warnings warnings;
        const Motion motion =
            files_.size() > 1 ? motion_of_poses(warnings) : motion_of_scene(warnings);
        options_.within_meshes = within_ || files_.size() > 1;
        std::vector<io::ContactStep> steps;
        Totals totals;
        {
            ProgressBar progress(common().quiet);
            search(motion, executor, progress, steps, totals);
        }
        io::write_whole_file(output_,
                             output_.ends_with(".csv") ? io::encode_contacts_csv(steps)
                                                       : io::encode_contacts(steps));
        if (!common().quiet) {
            print_warnings(warnings);
        }
        if (common().json || !common().quiet) {
            write_output(summary(motion, totals));
        }
    }

private:
    void check_options_of_poses() {
        for (const auto& [name, value] :
             {std::pair("--frames", &frames_), {"--animation", &animation_}}) {
            if (!value->empty()) {
                throw wrong_usage(app(), name, "goes with a scene that moves, not with poses");
            }
        }
    }

    Motion motion_of_scene(Warnings& warnings) {
        io::LoadedScene loaded = io::load_scene(files_.front(), {.animation = animation_});
        warnings = std::move(loaded.warnings);
        const geometry::AnimatedMesh& mesh = loaded.scene.mesh;
        Motion motion;
        motion.first_vertex.push_back(0);
        for (const geometry::Part& part : mesh.parts()) {
            motion.first_vertex.push_back(motion.first_vertex.back() + part.positions.size());
        }
        motion.triangles.resize(mesh.parts().size());
        for (const Triangle& triangle : mesh.triangles()) {
            const auto end = std::upper_bound(
                motion.first_vertex.begin(), motion.first_vertex.end(), triangle[0]);
            const auto part = static_cast<std::size_t>(end - motion.first_vertex.begin()) - 1;
            const auto first = static_cast<geometry::VertexId>(motion.first_vertex[part]);
            motion.triangles[part].push_back(
                {triangle[0] - first, triangle[1] - first, triangle[2] - first});
        }
        motion.times = times_of(mesh.duration());
        motion.positions = [mesh, times = motion.times](std::size_t i) {
            return mesh.positions_at(times[i]);
        };
        return motion;
    }

    std::vector<double> times_of(double duration) {
        if (!frames_.empty()) {
            const auto times = parse_frames(frames_);
            if (!times) {
                throw wrong_usage(
                    app(), "--frames", "'" + frames_ + "' is not of the form A:B:STEP in seconds");
            }
            return *times;
        }
        const auto steps = static_cast<std::size_t>(duration * kFramesPerSecond + 0.5);
        std::vector<double> times{0.0};
        for (std::size_t i = 1; i <= std::max<std::size_t>(steps, 1); ++i) {
            times.push_back(std::min(duration, static_cast<double>(i) / kFramesPerSecond));
        }
        return times;
    }

    Motion motion_of_poses(Warnings& warnings) const {
        Motion motion;
        std::vector<std::vector<Vec3>> poses;
        for (const std::string& file : files_) {
            io::LoadedScene loaded = io::load_scene(file, {});
            warnings.insert(warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
            const geometry::AnimatedMesh& mesh = loaded.scene.mesh;
            if (poses.empty()) {
                motion.triangles = {mesh.triangles()};
                motion.first_vertex = {0, mesh.vertex_count()};
            } else if (mesh.triangles() != motion.triangles.front() ||
                       mesh.vertex_count() != motion.first_vertex.back()) {
                throw Error(file,
                            "has other vertices or triangles than " + files_.front(),
                            "give poses of one mesh");
            }
            motion.times.push_back(static_cast<double>(motion.times.size()));
            poses.push_back(mesh.positions_at(0.0));
        }
        motion.positions = [poses = std::move(poses)](std::size_t i) { return poses[i]; };
        return motion;
    }

    void search(const Motion& motion,
                Executor& executor,
                Progress& progress,
                std::vector<io::ContactStep>& steps,
                Totals& totals) const {
        World world;
        for (std::size_t mesh = 0; mesh < motion.triangles.size(); ++mesh) {
            world.add_mesh(motion.triangles[mesh],
                           motion.first_vertex[mesh + 1] - motion.first_vertex[mesh]);
        }
        const auto start = std::chrono::steady_clock::now();
        // A discrete search is at instants, the last included.
        const std::size_t count_of_steps = motion.times.size() - (discrete_ ? 0 : 1);
        std::vector<Vec3> begin, end = motion.positions(0);
        for (std::size_t i = 0; i < count_of_steps; ++i) {
            const std::size_t next = std::min(i + 1, motion.times.size() - 1);
            begin = std::move(end);
            end = motion.positions(next);
            for (std::uint32_t mesh = 0; mesh < motion.triangles.size(); ++mesh) {
                const std::size_t first = motion.first_vertex[mesh];
                const std::size_t count = motion.first_vertex[mesh + 1] - first;
                world.update(mesh,
                             std::span(begin).subspan(first, count),
                             std::span(end).subspan(first, count));
            }
            steps.push_back({.t0 = motion.times[i],
                             .t1 = motion.times[discrete_ ? i : next],
                             .contacts = discrete_ ? world.contacts_at_begin(options_, executor)
                                                   : world.contacts(options_, executor)});
            ++totals.steps;
            totals.contacts += steps.back().contacts.size();
            totals.statistics.box_tests += world.statistics().box_tests;
            totals.statistics.triangle_pairs += world.statistics().triangle_pairs;
            totals.statistics.elementary_tests += world.statistics().elementary_tests;
            progress.report("steps", i + 1, count_of_steps);
        }
        totals.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    std::string summary(const Motion& motion, const Totals& totals) const {
        std::size_t triangles = 0;
        for (const auto& mesh : motion.triangles) {
            triangles += mesh.size();
        }
        if (common().json) {
            const nlohmann::ordered_json json = {
                {"version", 1},
                {"meshes", motion.triangles.size()},
                {"triangles", triangles},
                {"steps", totals.steps},
                {"contacts", totals.contacts},
                {"box_tests", totals.statistics.box_tests},
                {"triangle_pairs", totals.statistics.triangle_pairs},
                {"elementary_tests", totals.statistics.elementary_tests},
                {"seconds", totals.seconds},
                {"file", output_}};
            return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
        }
        std::array<char, 64> time{};
        std::snprintf(
            time.data(),
            time.size(),
            "time       %.3f s, %.1f ms a step\n",
            totals.seconds,
            totals.steps > 0 ? 1e3 * totals.seconds / static_cast<double>(totals.steps) : 0.0);
        return "meshes     " + std::to_string(motion.triangles.size()) + ", " +
               std::to_string(triangles) + " triangles\nsteps      " +
               std::to_string(totals.steps) + "\ncontacts   " + std::to_string(totals.contacts) +
               "\ntests      " + std::to_string(totals.statistics.box_tests) + " of boxes, " +
               std::to_string(totals.statistics.triangle_pairs) + " pairs of triangles, " +
               std::to_string(totals.statistics.elementary_tests) + " of elements\n" + time.data() +
               "file       " + output_ + "\n";
    }

    std::vector<std::string> files_;
    std::string output_, frames_, animation_;
    bool within_ = false, discrete_ = false;
    collision::ContactOptions options_;
};

}  // namespace

std::unique_ptr<Command> make_collide_command(CLI::App& program) {
    return std::make_unique<CollideCommand>(program);
}

}  // namespace earshot::cli
