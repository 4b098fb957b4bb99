// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/formatted.h"
#include "earshot/cli/ignore_option.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/update_summary.h"
#include "earshot/cli/values.h"
#include "earshot/io/line_of_sight_table.h"
#include "earshot/io/points.h"
#include "earshot/io/whole_file.h"
#include "earshot/visibility/coherent_line_of_sight.h"
#include "earshot/visibility/visible_share.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using geometry::TriangleId;
using geometry::Vec3;
using visibility::PointSets;

constexpr const char* kFooter =
    "POINTS is X,Y,Z or a CSV file of three columns. Two points see each other unless a triangle\n"
    "touches the segment between them, its ends and the triangle's edges included. The file has a\n"
    "row per point of --from and a column per point of --to; JSON holds the points beside.\n"
    "With --radius each cell is the share of the solid angle of a ball about the --to point that "
    "is\n"
    "seen, 0 to 1, and JSON tells the error beside it: 0 where one surface hides all of it or\n"
    "nothing is between, else at most 2.7 over the root of --rays.\n\n"
    "Examples:\n"
    "  earshot los scenes/classroom.gltf --from 2,1.5,3 --to seats.csv -o sight.csv\n"
    "      the seats that are visible from a speaker\n"
    "  earshot los scenes/door.gltf --from 1,1.5,1 --to 8,1.2,2 --frames 0:2:0.1 -o sight.json\n"
    "      when a door that opens lets through\n"
    "  earshot los scenes/classroom.gltf --from 2,1.5,3 --to seats.csv --radius 0.1 -o shares.csv\n"
    "      how much of each listener's head is visible";

constexpr std::size_t kMaxPairs = std::size_t{1} << 30U;

/// What is remembered from one instant to the next takes some ten bytes a pair.
constexpr std::size_t kMaxCoherentPairs = std::size_t{1} << 27U;

class LosCommand : public Command {
public:
    explicit LosCommand(CLI::App& program)
        : Command(program, "los", "Line of sight between sets of points") {
        scene_.add_to(app(), "a matrix for each");
        app().add_option("--from", from_option_, "points to look from")->required();
        app().add_option("--to", to_option_, "points to look at")->required();
        add_output("-o,--output", output_, "the file to write: .csv, or .json")->required();
        ignore_.add_to(app());
        app().add_flag(
            "--blockers", with_blockers_, "the triangle that blocks first instead of 1 and 0");
        add_number(app(),
                   "--radius",
                   radius_,
                   {0.0, 1e6},
                   "of a ball about each point of --to, metres: tell how much of it is seen")
            ->excludes("--blockers");
        add_integer(app(),
                    "--rays",
                    rays_,
                    {8, 1048576},
                    "with --radius: maximum number of rays for a share; default: 2048");
        app().footer(kFooter);
    }

    void run() override {
        override_simd_target(common().simd);
        Executor executor(static_cast<int>(common().threads));
        const std::vector<double> times = scene_.times(app());
        const io::LoadedScene loaded = scene_.load();
        const std::vector<Vec3> from = points_of("--from", from_option_);
        const std::vector<Vec3> to = points_of("--to", to_option_);
        if (from.size() > kMaxPairs / to.size()) {
            throw Error("points",
                        std::to_string(from.size()) + " x " + std::to_string(to.size()) +
                            " pairs are more than 2^30",
                        "give fewer at a time");
        }
        const auto start = std::chrono::steady_clock::now();
        {
            ProgressBar progress(common().quiet);
            write(loaded.scene, times, {from, to}, executor, progress);
        }
        seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (!common().quiet) {
            print_warnings(loaded.warnings);
        }
        if (common().json || !common().quiet) {
            write_output(summary({from, to}, times.size()));
        }
    }

private:
    std::vector<Vec3> points_of(const std::string& option, const std::string& text) const {
        if (const auto point = parse_point(text)) {
            return {scene_.to_scene(*point)};
        }
        if (text.find(',') != std::string::npos && !std::filesystem::exists(text)) {
            throw Error(
                option, "'" + text + "' is not of the form X,Y,Z", "give a point or a file");
        }
        std::vector<Vec3> points = io::read_points(text);
        for (Vec3& point : points) {
            point = scene_.to_scene(point);
        }
        return points;
    }

    void write(const propagation::Scene& scene,
               const std::vector<double>& times,
               const PointSets& points,
               Executor& executor,
               Progress& progress) {
        const bool is_json = output_.ends_with(".json");
        io::LineOfSightJson json(scene.name, points);
        const io::SightRows rows = radius_ > 0.0    ? io::SightRows::shares
                                   : with_blockers_ ? io::SightRows::blockers
                                                    : io::SightRows::visible;
        const visibility::ExclusionMask excluded = ignore_.mask_for(scene);
        std::optional<bvh::DeformableBvh> tree;
        std::optional<visibility::CoherentLineOfSight> coherent;
        std::vector<Vec3> positions;
        for (std::size_t frame = 0; frame < times.size(); ++frame) {
            const std::vector<Vec3> before =
                std::exchange(positions, scene.mesh.positions_at(times[frame]));
            const geometry::MeshView mesh{positions, scene.mesh.triangles()};
            io::LineOfSightCsv csv;
            const auto take = [&](auto row) {
                free_ += static_cast<std::size_t>(std::count_if(
                    row.begin(), row.end(), [&](auto cell) { return is_free(cell); }));
                is_json ? json.add_row(row) : csv.add_row(row);
            };
            json.begin_frame(times[frame], rows);
            const std::size_t pairs = points.from.size() * points.to.size();
            const bvh::UpdateOptions update = {.queries_per_update = static_cast<double>(pairs)};
            // Temporal coherence pays if there are enough pairs.
            if (rows == io::SightRows::visible && times.size() > 1 &&
                pairs >= mesh.triangles.size() && pairs <= kMaxCoherentPairs) {
                if (!coherent) {
                    coherent.emplace(mesh, excluded, update, executor);
                }
                const std::vector<std::uint8_t>& seen = coherent->matrix(mesh, points, executor);
                for (std::size_t row = 0; row < points.from.size(); ++row) {
                    take(std::span(seen).subspan(row * points.to.size(), points.to.size()));
                }
            } else {
                if (tree) {
                    tree->update(mesh, bvh::moved_triangles(mesh, before, executor), executor);
                } else {
                    tree.emplace(mesh, update, executor);
                }
                if (rows == io::SightRows::shares) {
                    take_shares(tree->view(), points, excluded, executor, take);
                } else if (with_blockers_) {
                    blocker_matrix(tree->view(), points, excluded, executor, take);
                } else {
                    visibility_matrix(tree->view(), points, excluded, executor, take);
                }
            }
            updates_ = coherent ? coherent->update_statistics() : tree->update_statistics();
            json.end_frame();
            if (!is_json) {
                io::write_whole_file(scene_.file_of_frame(output_, frame), csv.text());
            }
            progress.report("instants", frame + 1, times.size());
        }
        if (is_json) {
            io::write_whole_file(output_, json.finish());
        }
    }

    template <class Take>
    void take_shares(const bvh::MeshBvh& bvh,
                     const PointSets& points,
                     const visibility::ExclusionMask& excluded,
                     Executor& executor,
                     const Take& take) const {
        const visibility::VisibleShareQuery query(bvh, excluded, executor);
        for (const Vec3& from : points.from) {
            const auto row = query.matrix({&from, 1},
                                          points.to,
                                          radius_,
                                          {.max_rays = static_cast<std::size_t>(rays_)},
                                          executor);
            take(std::span(row));
        }
    }

    static bool is_free(const visibility::VisibleShare& share) noexcept {
        return share.share > 0.0;
    }
    static bool is_free(std::uint8_t seen) noexcept { return seen != 0; }
    static bool is_free(TriangleId blocker) noexcept { return blocker == visibility::kNoBlocker; }

    std::string summary(const PointSets& points, std::size_t instants) const {
        const std::size_t pairs = points.from.size() * points.to.size() * instants;
        if (common().json) {
            const nlohmann::ordered_json json = {{"version", 1},
                                                 {"from", points.from.size()},
                                                 {"to", points.to.size()},
                                                 {"instants", instants},
                                                 {"visible", free_},
                                                 {"hierarchy", update_json(updates_)},
                                                 {"seconds", seconds_},
                                                 {"file", output_}};
            return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
        }
        return "pairs      " + std::to_string(pairs) + ", " + std::to_string(free_) +
               " see each other\n" + formatted("time       %.3f s\n", seconds_) + "file       " +
               output_ + "\n";
    }

    SceneChoice scene_;
    IgnoreOption ignore_;
    std::string from_option_, to_option_, output_;
    bool with_blockers_ = false;
    double radius_ = 0.0;
    std::int64_t rays_ = 2048;
    std::size_t free_ = 0;
    bvh::UpdateStatistics updates_;
    double seconds_ = 0.0;
};

}  // namespace

std::unique_ptr<Command> make_los_command(CLI::App& program) {
    return std::make_unique<LosCommand>(program);
}

}  // namespace earshot::cli
