// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/pvs_report.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/values.h"
#include "earshot/io/visibility_file.h"
#include "earshot/visibility/build_visible_sets.h"

#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using geometry::Vec3;
using namespace visibility;

constexpr const char* kFooter =
    "Without --cells and --grid the region is one cell, sampled by what is found (guided); with\n"
    "them all cells are filled at the same time. Sets are what rays proved to be visible: nothing\n"
    "in them is wrong, something may be missing. Fresh validation rays, from viewpoints uniform "
    "in\n"
    "the region in directions uniform on the sphere, measure in what share of all directions it "
    "is,\n"
    "with a bound that holds in 95 % of all cases. Sets hold for the scene at one instant.\n\n"
    "Examples:\n"
    "  earshot pvs build scenes/city.gltf --region 126,1,126:130,3,130 -o square.pvs\n"
    "      what can be seen from a square\n"
    "  earshot pvs build scenes/city.gltf --region 1,1,1:239,3,239 --cells 200 -o streets.pvs\n"
    "      the same from everywhere in the streets, in cells that follow what is seen\n"
    "  earshot ir scenes/classroom.gltf --visibility classroom.pvs -o out\n"
    "      sound paths that are first reflected by what the source's cell can see";

class PvsBuildCommand : public Command {
public:
    explicit PvsBuildCommand(CLI::App& group)
        : Command(group,
                  "build",
                  "Sample what can be seen from a region or its cells",
                  {.seed = true}) {
        scene_.add_to(app());
        add_output("-o,--output", output_, "the file to write")->required();
        app().add_option(
            "--region", region_option_, "X,Y,Z:X,Y,Z, metres; default: the scene's box");
        CLI::Option* cells =
            add_integer(app(),
                        "--cells",
                        cells_,
                        {1, kMaxCells},
                        "number of cells; the region is divided where visibility changes");
        app()
            .add_option("--grid", grid_option_, "divide the region into NX,NY,NZ boxes instead")
            ->excludes(cells);
        add_integer(app(),
                    "--objects",
                    triangles_per_object_,
                    {1, kMaxTrianglesPerObject},
                    "triangles that are taken together; default: 1");
        add_integer(
            app(), "--rays", rays_, {1}, "most rays; default: 10 or, with cells, 20 million");
        add_integer(
            app(),
            "--validation",
            validation_rays_,
            {0},
            "fresh rays that measure what the sets miss; default: a tenth of the rays, 65536 "
            "at least");
        add_number(app(), "--seconds", seconds_, {.min = 0.0}, "stop after so long as well");
        add_integer(app(),
                    "--until",
                    until_,
                    {0},
                    "stop when a million rays found fewer triangles (default: 50), or, with cells, "
                    "when no set grew by more in 5 million (default: 5)");
        add_integer(app(),
                    "--segments",
                    segments_,
                    {1, kMaxSegments},
                    "number of sample segments for --cells; default: 200000");
        app().add_flag("--skip-solids",
                       skip_solids_,
                       "skip segments inside closed solids; front faces must face the air");
        app().footer(kFooter);
    }

    void run() override {
        override_simd_target(common().simd);
        Executor executor(static_cast<int>(common().threads));
        const auto grid = grid_counts();
        const auto given_region = region_given();
        const io::LoadedScene loaded = scene_.load();
        const double time = scene_.times(app()).front();
        const std::vector<Vec3> positions = loaded.scene.mesh.positions_at(time);
        const geometry::MeshView mesh = {positions, loaded.scene.mesh.triangles()};
        const bvh::DeformableBvh hierarchy(mesh, {}, executor);
        const ViewRegion region = given_region ? *given_region : region_of(hierarchy.tree().box());
        start_ = std::chrono::steady_clock::now();
        std::optional<VisibleSets> sets;
        {
            ProgressBar progress(common().quiet);
            sets = build_visible_sets(hierarchy.view(),
                                      region,
                                      sets_options(grid, progress),
                                      {.scene = loaded.scene.name,
                                       .time = time,
                                       .mesh_digest = mesh_digest(mesh),
                                       .seed = static_cast<std::uint64_t>(common().seed)},
                                      executor);
        }
        io::write_visible_sets(output_, *sets);
        if (!common().quiet) {
            print_warnings(loaded.warnings);
        }
        if (common().json || !common().quiet) {
            const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start_;
            write_output(pvs_summary(*sets, output_, taken.count(), common().json));
        }
    }

private:
    static constexpr std::int64_t kMaxCells = 1 << 20;
    static constexpr std::int64_t kMaxTrianglesPerObject = 1 << 30;
    static constexpr std::int64_t kMaxSegments = 100'000'000;

    std::optional<std::array<std::uint32_t, 3>> grid_counts() {
        if (grid_option_.empty()) {
            return std::nullopt;
        }
        const auto counts = parse_point(grid_option_);
        std::array<std::uint32_t, 3> result{};
        bool is_right = counts.has_value();
        for (std::size_t k = 0; is_right && k < 3; ++k) {
            const double count = (*counts)[static_cast<int>(k)];
            is_right = count >= 1.0 && count <= kMaxCells && count == std::floor(count);
            result[k] = is_right ? static_cast<std::uint32_t>(count) : 0;
        }
        if (!is_right) {
            throw wrong_usage(
                app(), "--grid", "'" + grid_option_ + "' is not of the form NX,NY,NZ");
        }
        return result;
    }

    std::optional<ViewRegion> region_given() {
        if (region_option_.empty()) {
            return std::nullopt;
        }
        const auto corners = parse_corners(region_option_);
        if (!corners) {
            throw wrong_usage(
                app(), "--region", "'" + region_option_ + "' is not of the form X,Y,Z:X,Y,Z");
        }
        ViewRegion region{scene_.to_scene((*corners)[0]), scene_.to_scene((*corners)[1])};
        if (scene_.frame().up == io::UpAxis::z) {
            std::swap(region.lower.z, region.upper.z);  // the turn reverses this axis
        }
        return region;
    }

    Interrupt deadline() const {
        if (seconds_ == kNoLimit) {
            return {};
        }
        const std::chrono::duration<double> most(seconds_);
        return [start = start_, most] { return std::chrono::steady_clock::now() - start >= most; };
    }

    VisibleSetsOptions sets_options(const std::optional<std::array<std::uint32_t, 3>>& grid,
                                    Progress& progress) const {
        VisibleSetsOptions options = {
            .max_cells = static_cast<std::size_t>(cells_),
            .grid = grid,
            .triangles_per_object = static_cast<std::size_t>(triangles_per_object_),
            .segments = static_cast<std::size_t>(segments_),
            .skip_solids = skip_solids_,
            .progress = &progress,
            .interrupt = deadline()};
        if (rays_ > 0) {
            options.max_rays = static_cast<std::uint64_t>(rays_);
        }
        if (until_ >= 0) {
            options.until = static_cast<std::uint64_t>(until_);
        }
        if (validation_rays_ >= 0) {
            options.validation_rays = static_cast<std::uint64_t>(validation_rays_);
        }
        return options;
    }

    static constexpr double kNoLimit = -1.0;

    SceneChoice scene_;
    std::string output_, region_option_, grid_option_;
    std::int64_t cells_ = 0;
    std::int64_t triangles_per_object_ = 1;
    std::int64_t rays_ = 0;
    std::int64_t until_ = -1;
    std::int64_t validation_rays_ = -1;  // -1: not given
    std::int64_t segments_ = 200'000;
    double seconds_ = kNoLimit;
    bool skip_solids_ = false;
    std::chrono::steady_clock::time_point start_;
};

}  // namespace

std::unique_ptr<Command> make_pvs_build_command(CLI::App& group) {
    return std::make_unique<PvsBuildCommand>(group);
}

}  // namespace earshot::cli
