// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/ignore_option.h"
#include "earshot/cli/output.h"
#include "earshot/cli/picture_choice.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/values.h"
#include "earshot/cli/visible_summary.h"
#include "earshot/io/visible_table.h"
#include "earshot/io/whole_file.h"
#include "earshot/visibility/line_of_sight.h"
#include "earshot/visibility/visible_triangles.h"

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using geometry::MeshView;
using geometry::Vec3;
using visibility::VisibleTriangles;

constexpr const char* kFooter =
    "Every triangle that is listed is visible: the direction beside it proves that. An item "
    "buffer\n"
    "of one ray per --resolution comes first; then adaptive sampling finds triangles between its\n"
    "rays. Shares are of the whole sphere.\n\n"
    "Examples:\n"
    "  earshot visible scenes/classroom.gltf --from 2,1.5,3\n"
    "      how much of the sphere each material covers\n"
    "  earshot visible scenes/classroom.gltf --from 2,1.5,3 -o seen.csv --image seen.png\n"
    "      the triangles that are seen, and a panorama of them\n"
    "  earshot visible scenes/city.gltf --from 40,30,40 --look-at 0,0,0 --colour depth \\\n"
    "      --image-size 1600x900 --image city.png";

class VisibleCommand : public Command {
public:
    explicit VisibleCommand(CLI::App& program)
        : Command(program, "visible", "The triangles and materials that are visible from a point") {
        scene_.add_to(app(), "files for each");
        app().add_option("--from", from_option_, "the viewpoint, X,Y,Z")->required();
        add_number(app(),
                   "--resolution",
                   resolution_,
                   {0.01, 10.0},
                   "degrees between neighbouring rays; default: 0.5");
        app().add_flag("--no-refinement", is_coarse_, "leave out the search between these rays");
        ignore_.add_to(app());
        add_output("-o,--output", output_, "the triangles: a .csv or .json file");
        picture_.add_to(app());
        app().footer(kFooter);
    }

    void run() override {
        override_simd_target(common().simd);
        Executor executor(static_cast<int>(common().threads));
        const std::vector<double> times = scene_.times(app());
        const auto from = parse_point(from_option_);
        if (!from) {
            throw wrong_usage(app(), "--from", "'" + from_option_ + "' is not of the form X,Y,Z");
        }
        point_ = scene_.to_scene(*from);
        const visibility::View view = picture_.view_from(app(), scene_, point_);
        if (output_.empty() && !picture_.is_chosen() && common().quiet && !common().json) {
            throw wrong_usage(app(), "--quiet", "leaves nothing to do without -o or --image");
        }
        if (picture_.is_chosen()) {
            io::require_writable(picture_.file());
        }
        io::LoadedScene loaded = scene_.load();
        VisibleSummary summary(loaded.scene);
        const auto start = std::chrono::steady_clock::now();
        {
            ProgressBar progress(common().quiet);
            find_visible(loaded, times, view, executor, progress, summary);
        }
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (!common().quiet) {
            print_warnings(loaded.warnings);
        }
        const VisibleSummary::Outputs outputs{
            .point = point_, .seconds = seconds, .file = output_, .picture = picture_};
        if (common().json) {
            write_output(summary.json(outputs));
        } else if (!common().quiet) {
            write_output(summary.text(outputs));
        }
    }

private:
    void find_visible(io::LoadedScene& loaded,
                      const std::vector<double>& times,
                      const visibility::View& view,
                      Executor& executor,
                      Progress& progress,
                      VisibleSummary& summary) {
        const propagation::Scene& scene = loaded.scene;
        const visibility::ExclusionMask excluded = ignore_.mask_for(scene);
        const visibility::VisibleTrianglesOptions options{
            .resolution = resolution_ * math::kPi / 180.0,
            .refine = !is_coarse_,
            .excluded = excluded};
        io::VisibleJson json(scene, point_, options.resolution);
        std::optional<bvh::DeformableBvh> tree;
        std::uint64_t rays = 0;  // of the last instant, and of its picture
        Progress* const inner = times.size() == 1 ? &progress : nullptr;
        std::vector<Vec3> positions;
        for (std::size_t frame = 0; frame < times.size(); ++frame) {
            const std::vector<Vec3> before =
                std::exchange(positions, scene.mesh.positions_at(times[frame]));
            const MeshView mesh{positions, scene.mesh.triangles()};
            if (tree) {
                tree->expect_queries(static_cast<double>(rays));
                tree->update(mesh, bvh::moved_triangles(mesh, before, executor), executor);
            } else {
                tree.emplace(mesh, bvh::UpdateOptions{}, executor);
            }
            warn_on_surface(tree->view(), excluded, loaded.warnings);
            const VisibleTriangles visible =
                visible_triangles(tree->view(), point_, options, executor, inner);
            summary.add_frame(visible);
            rays = visible.rays;
            write(visible, json, times, frame);
            if (picture_.is_chosen()) {
                const visibility::ItemBuffer buffer =
                    render_item_buffer(tree->view(), point_, view, excluded, executor, inner);
                io::write_png(scene_.file_of_frame(picture_.file(), frame),
                              picture_.paint(buffer, mesh, scene));
                rays += buffer.triangles.size();
            }
            progress.report("instants", frame + 1, times.size());
        }
        summary.set_updates(tree->update_statistics());
    }

    /// Rounding decides which rays are stopped by a triangle that the point lies on.
    void warn_on_surface(const bvh::MeshBvh& bvh,
                         const visibility::ExclusionMask& excluded,
                         Warnings& warnings) {
        const auto touched = visibility::first_blocker(bvh, {point_, point_}, excluded);
        if (touched && !has_warned_) {
            has_warned_ = true;
            warnings.push_back({from_option_,
                                "lies on triangle " + std::to_string(touched->triangle) +
                                    ", and what that hides is a matter of rounding; move it off"});
        }
    }

    void write(const VisibleTriangles& visible,
               io::VisibleJson& json,
               const std::vector<double>& times,
               std::size_t frame) const {
        if (output_.ends_with(".json")) {
            json.add_frame(times[frame], visible);
            if (frame + 1 == times.size()) {
                io::write_whole_file(output_, json.finish());
            }
        } else if (!output_.empty()) {
            io::write_whole_file(scene_.file_of_frame(output_, frame),
                                 io::encode_visible_csv(visible));
        }
    }

    SceneChoice scene_;
    IgnoreOption ignore_;
    PictureChoice picture_;
    std::string from_option_, output_;
    double resolution_ = 0.5;  // degrees
    bool is_coarse_ = false;
    bool has_warned_ = false;
    Vec3 point_{};
};

}  // namespace

std::unique_ptr<Command> make_visible_command(CLI::App& program) {
    return std::make_unique<VisibleCommand>(program);
}

}  // namespace earshot::cli
