// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/cli/commands.h"
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
#include <vector>

namespace earshot::cli {
namespace {

using geometry::MeshView;
using geometry::TriangleId;
using geometry::Vec3;
using visibility::VisibleTriangles;

constexpr const char* kFooter =
    "Every triangle that is listed is seen: the direction beside it proves that. The sweep casts "
    "a\n"
    "ray per --resolution; then what lies between is looked for. Shares are of the whole "
    "sphere.\n\n"
    "Examples:\n"
    "  earshot visible scenes/classroom.gltf --from 2,1.5,3\n"
    "      how much of the sphere each material covers\n"
    "  earshot visible scenes/classroom.gltf --from 2,1.5,3 -o seen.csv --image seen.png\n"
    "      the triangles that are seen, and a panorama of them\n"
    "  earshot visible scenes/city.gltf --from 40,30,40 --look-at 0,0,0 --colour depth \\\n"
    "      --image-size 1600x900 --image city.png";

/// A scene's triangles but those of ignored materials.
struct Kept {
    std::vector<geometry::Triangle> triangles;
    std::vector<TriangleId> ids;  // of these in the scene
};

class VisibleCommand : public Command {
public:
    explicit VisibleCommand(CLI::App& program)
        : Command(program, "visible", "Which triangles and materials a point sees") {
        scene_.add_to(app(), "files for each");
        app().add_option("--from", from_option_, "the point that looks, X,Y,Z")->required();
        add_number(app(),
                   "--resolution",
                   resolution_,
                   {0.01, 10.0},
                   "degrees between the rays of the sweep; default: 0.5");
        app().add_flag("--no-refinement", is_coarse_, "leave out what the sweep misses");
        add_repeatable(
            app(), "--ignore", ignored_, "a material that is looked through; may be repeated");
        app().add_option("-o,--output", output_, "the triangles: a .csv or .json file");
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
        point_ = *from;
        const visibility::View view = picture_.view_from(app(), point_);
        if (output_.empty() && !picture_.is_chosen() && common().quiet && !common().json) {
            throw wrong_usage(app(), "--quiet", "leaves nothing to do without -o or --image");
        }
        io::LoadedScene loaded = scene_.load();
        VisibleSummary summary(loaded.scene);
        const auto start = std::chrono::steady_clock::now();
        {
            ProgressBar progress(common().quiet);
            look(loaded, times, view, executor, progress, summary);
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
    void look(io::LoadedScene& loaded,
              const std::vector<double>& times,
              const visibility::View& view,
              Executor& executor,
              Progress& progress,
              VisibleSummary& summary) {
        const propagation::Scene& scene = loaded.scene;
        const Kept kept = kept_of(scene);
        const visibility::VisibleTrianglesOptions options{
            .resolution = resolution_ * math::kPi / 180.0, .refine = !is_coarse_};
        io::VisibleJson json(scene, point_, options.resolution);
        std::optional<bvh::DeformableBvh> tree;
        Progress* const inner = times.size() == 1 ? &progress : nullptr;
        for (std::size_t frame = 0; frame < times.size(); ++frame) {
            const std::vector<Vec3> positions = scene.mesh.positions_at(times[frame]);
            const MeshView mesh{positions, kept.triangles};
            if (tree) {
                tree->update(mesh, executor);
            } else {
                tree.emplace(mesh, bvh::UpdateOptions{}, executor);
            }
            warn_on_surface(tree->tree(), mesh, kept, loaded.warnings);
            VisibleTriangles visible =
                visible_triangles(tree->tree(), mesh, point_, options, executor, inner);
            name(visible, kept);
            summary.add_frame(visible);
            write(visible, json, times, frame);
            if (picture_.is_chosen()) {
                visibility::ItemBuffer buffer =
                    render_item_buffer(tree->tree(), mesh, point_, view, executor, inner);
                name(buffer, kept);
                io::write_png(scene_.file_of_frame(picture_.file(), frame),
                              picture_.paint(buffer, {positions, scene.mesh.triangles()}, scene));
            }
            progress.report("instants", frame + 1, times.size());
        }
    }

    /// Numbers of the scene instead of those among what was kept.
    static void name(VisibleTriangles& visible, const Kept& kept) {
        for (visibility::VisibleTriangle& entry : visible.triangles) {
            entry.triangle = kept.ids[entry.triangle];
        }
    }
    static void name(visibility::ItemBuffer& buffer, const Kept& kept) {
        for (TriangleId& id : buffer.triangles) {
            id = id == visibility::kNoTriangle ? id : kept.ids[id];
        }
    }

    Kept kept_of(const propagation::Scene& scene) const {
        std::vector<bool> is_ignored(scene.materials.size());
        for (const std::string& name : ignored_) {
            is_ignored[material_named(scene, name)] = true;
        }
        Kept kept;
        const auto& triangles = scene.mesh.triangles();
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            if (!is_ignored[scene.material_of_triangle[i]]) {
                kept.triangles.push_back(triangles[i]);
                kept.ids.push_back(static_cast<TriangleId>(i));
            }
        }
        return kept;
    }

    /// Which rays a triangle stops that the point lies on is a matter of rounding.
    void warn_on_surface(const bvh::WideTree& tree,
                         const MeshView& mesh,
                         const Kept& kept,
                         Warnings& warnings) {
        const auto touched = visibility::first_blocker(tree, mesh, {point_, point_});
        if (touched && !has_warned_) {
            has_warned_ = true;
            warnings.push_back({from_option_,
                                "lies on triangle " + std::to_string(kept.ids[touched->triangle]) +
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
    PictureChoice picture_;
    std::string from_option_, output_;
    std::vector<std::string> ignored_;
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
