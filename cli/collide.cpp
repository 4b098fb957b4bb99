// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/cli/collide_motion.h"
#include "earshot/cli/collide_summary.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/report_output.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/values.h"
#include "earshot/io/contacts.h"
#include "earshot/io/report_contacts.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using collision::World;

constexpr const char* kFooter =
    "The meshes are the nodes of a glTF scene, or the objects and groups of an OBJ, of which "
    "those\n"
    "that share a vertex are one; several files are poses of one mesh, and then it is tested\n"
    "against itself. Within a mesh, vertices at one position at every instant are one vertex.\n"
    "Between two instants every vertex moves on a straight line, with --rigid on the screw of its\n"
    "node. No contact is missed, and no time of impact is late.\n\n"
    "Examples:\n"
    "  earshot collide scenes/door.gltf --frames 0:2:0.1 -o contacts.json\n"
    "      what of the door meets the frame between 0 and 2 s\n"
    "  earshot collide rotor.gltf --rigid --first -o contacts.json\n"
    "      when a part that turns first touches another\n"
    "  earshot collide parts.obj --discrete --distance --summary -o contacts.json\n"
    "      which parts intersect, how far apart the others are, how deep convex ones overlap\n"
    "  earshot collide cloth_00.ply cloth_01.ply cloth_02.ply -o contacts.csv\n"
    "      where cloth runs into itself, from file to file";

constexpr double kFramesPerSecond = 30.0;

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
        add_allow_outside(app(), allow_outside_);
        app().add_flag("--discrete",
                       discrete_,
                       "pairs of triangles that intersect at each instant, instead of contacts "
                       "between instants");
        app().add_flag("--rigid",
                       rigid_,
                       "meshes whose nodes are rigid rotate between instants, instead of every "
                       "vertex on a straight line");
        app().add_flag("--self", within_, "meshes are tested against themselves too");
        app().add_flag("--no-weld",
                       keep_split_,
                       "vertices of a mesh at one position at every instant stay different "
                       "vertices");
        app().add_flag("--distance",
                       distance_,
                       "also tells how far apart meshes are at the beginning of each step, with "
                       "the closest points, and how deep convex solids overlap");
        app().add_flag("--first", summary_.first, "stops at the first contact");
        app().add_flag("--summary", summary_.pairs, "prints a line for each pair of meshes");
        add_number(app(),
                   "--min-separation",
                   options_.min_separation,
                   {0.0, 1e6},
                   "elements this close along every axis are in contact, metres");
        add_number(app(),
                   "--tolerance",
                   options_.tolerance,
                   {1e-12, 1e6},
                   "how much farther apart may count as closer, with --min-separation, metres");
        app().add_flag("--report",
                       writes_report_,
                       "also write a page for the browser that shows the contacts, named like the "
                       "output, .html");
        app().footer(kFooter);
    }

    void run() override {
        check_options();
        if (writes_report_) {
            require_report(page_file());
        }
        override_simd_target(common().simd);
        Executor executor(static_cast<int>(common().threads));
        Warnings warnings;
        CollideMotion motion = load(warnings);
        options_.within_meshes = within_ || files_.size() > 1;
        io::ContactReport report{.meshes = motion.mesh_names};
        CollideTotals totals;
        {
            ProgressBar progress(common().quiet);
            search(motion, executor, progress, report, totals);
        }
        write(report, executor);
        if (writes_report_) {
            write_page(report, warnings);
        }
        if (!discrete_ && !rigid_ && files_.size() == 1) {
            const Warnings turns = warn_of_turns(motion, files_.front());
            warnings.insert(warnings.end(), turns.begin(), turns.end());
        }
        if (!common().quiet) {
            print_warnings(warnings);
        }
        if (common().json || !common().quiet) {
            write_output(common().json
                             ? collide_summary_json(motion, report, totals, summary_, output_)
                             : collide_summary(motion, report, totals, summary_, output_));
        }
    }

private:
    void check_options() {
        if (files_.size() > 1) {
            for (const auto& [name, value] :
                 {std::pair("--frames", &frames_), {"--animation", &animation_}}) {
                if (!value->empty()) {
                    throw wrong_usage(app(), name, "goes with a scene that moves, not with poses");
                }
            }
        }
        if (rigid_ && (discrete_ || files_.size() > 1)) {
            throw wrong_usage(app(),
                              "--rigid",
                              discrete_ ? "goes with contacts between instants, not with --discrete"
                                        : "goes with a scene that moves, not with poses");
        }
        if (distance_ && output_.ends_with(".csv")) {
            throw wrong_usage(app(), "--distance", "needs a file that ends in .json");
        }
    }

    io::SceneOptions scene_options() const {
        return {.animation = animation_, .allow_outside = allow_outside_};
    }

    CollideMotion load(Warnings& warnings) {
        std::vector<geometry::AnimatedMesh> meshes;
        for (const std::string& file : files_) {
            io::LoadedScene loaded = io::load_scene(file, scene_options());
            warnings.insert(warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
            meshes.push_back(std::move(loaded.scene.mesh));
        }
        if (writes_report_) {
            shown_ = meshes;
        }
        if (files_.size() > 1) {
            return motion_of_poses(files_, meshes, !keep_split_);
        }
        std::vector<double> times = times_of(meshes.front().duration());
        return motion_of_scene(std::move(meshes.front()),
                               std::move(times),
                               !keep_split_,
                               rigid_ ? collision::Path::screws : collision::Path::chords);
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
        // A scene that does not move has one instant.
        std::vector<double> times{0.0};
        const auto steps = static_cast<std::size_t>(duration * kFramesPerSecond + 0.5);
        const std::size_t count = duration > 0.0 ? std::max<std::size_t>(steps, 1) : 0;
        for (std::size_t i = 1; i <= count; ++i) {
            times.push_back(std::min(duration, static_cast<double>(i) / kFramesPerSecond));
        }
        return times;
    }

    void search(CollideMotion& motion,
                Executor& executor,
                Progress& progress,
                io::ContactReport& report,
                CollideTotals& totals) const {
        World& world = motion.world;
        const auto start = std::chrono::steady_clock::now();
        // A discrete search is at instants, the last included; one instant is a step of its own.
        const std::size_t instants = motion.times.size();
        const std::size_t count_of_steps =
            discrete_ ? instants : std::max<std::size_t>(instants - 1, 1);
        for (std::size_t i = 0; i < count_of_steps; ++i) {
            const std::size_t next = discrete_ ? i : std::min(i + 1, instants - 1);
            motion.set_step(world, i, next);
            io::ContactStep& step = report.steps.emplace_back(
                io::ContactStep{.t0 = motion.times[i], .t1 = motion.times[next]});
            step.contacts = contacts_of_step(world, executor);
            totals.statistics += world.statistics();
            if (distance_) {
                step.distances = distances(world, executor, totals.statistics);
            }
            ++totals.steps;
            totals.contacts += step.contacts.size();
            progress.report("steps", i + 1, count_of_steps);
            if (summary_.first && !step.contacts.empty()) {
                break;
            }
        }
        totals.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    /// With --first no more than the first.
    std::vector<collision::Contact> contacts_of_step(World& world, Executor& executor) const {
        if (summary_.first && !discrete_) {
            const auto first = world.first_contact(options_, executor);
            return first ? std::vector{*first} : std::vector<collision::Contact>{};
        }
        auto contacts = discrete_ ? world.contacts_at_begin(options_, executor)
                                  : world.contacts(options_, executor);
        if (summary_.first && !contacts.empty()) {
            contacts.resize(1);
        }
        return contacts;
    }

    /// Of all pairs of meshes that are tested.
    std::vector<io::PairDistance> distances(World& world,
                                            Executor& executor,
                                            collision::WorldStatistics& statistics) const {
        std::vector<io::PairDistance> result;
        for (std::uint32_t a = 0; a < world.mesh_count(); ++a) {
            for (std::uint32_t b = a; b < world.mesh_count(); ++b) {
                if (!options_.accepts(a, b)) {
                    continue;
                }
                io::PairDistance pair{.a = a, .b = b, .depth = world.depth_at_begin(a, b)};
                if (a != b) {
                    pair.distance = world.distance_at_begin(a, b, executor);
                    statistics += world.statistics();
                }
                if (pair.distance || pair.depth) {
                    result.push_back(pair);
                }
            }
        }
        return result;
    }

    void write(const io::ContactReport& report, Executor& executor) const {
        if (output_.ends_with(".csv")) {
            io::write_whole_file(output_, io::encode_contacts_csv(report.steps));
        } else {
            io::write_whole_file(output_, [&](const io::ByteSink& sink) {
                io::write_contacts(report, sink, executor);
            });
        }
    }

    std::filesystem::path page_file() const {
        return std::filesystem::path(output_).replace_extension(".html");
    }

    /// Poses are one mesh, whatever their files divide it into.
    void write_page(const io::ContactReport& report, const Warnings& warnings) const {
        const geometry::AnimatedMesh& mesh = shown_.front();
        const bool has_poses = shown_.size() > 1;
        const std::vector<std::uint32_t> one_mesh(has_poses ? mesh.triangles().size() : 0, 0);
        io::ContactsPage page{
            .title = std::filesystem::path(files_.front()).stem().string(),
            .provenance = {.version = program_version(), .command = command_line()},
            .contacts = report,
            .triangles = mesh.triangles(),
            .mesh_of_triangle = has_poses ? one_mesh : mesh.mesh_of_triangle(),
            .warnings = warnings};
        for (const std::string& file : files_) {
            page.provenance.files.push_back(std::filesystem::path(file).filename().string());
        }
        page.positions_at = [&](double time) {
            return has_poses ? shown_[static_cast<std::size_t>(time)].positions_at(0.0)
                             : mesh.positions_at(time);
        };
        write_report(page_file(), io::encode_contacts_page(page));
    }

    std::vector<std::string> files_;
    bool writes_report_ = false;
    std::vector<geometry::AnimatedMesh> shown_;  // for the page
    std::string output_, frames_, animation_;
    bool within_ = false, discrete_ = false, rigid_ = false, distance_ = false;
    bool keep_split_ = false, allow_outside_ = false;
    CollideSummaryOptions summary_;
    collision::ContactOptions options_;
};

}  // namespace

std::unique_ptr<Command> make_collide_command(CLI::App& program) {
    return std::make_unique<CollideCommand>(program);
}

}  // namespace earshot::cli
