// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/bvh/builder_names.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/hierarchy_report.h"
#include "earshot/cli/output.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kNotes =
    "Times run from vertex positions to a tree that is ready for queries; each is the median of\n"
    "five. The SAH cost is the expected work of a random ray, in triangle tests. Over frames, a\n"
    "step is a visit of a node or leaf of the wide tree; `updated` is the tree that chooses "
    "between\n"
    "refit, repair and rebuild.\n\n";

constexpr const char* kExamples =
    "\nExamples:\n"
    "  earshot bvh hall.gltf                        nodes, depth, cost, memory, times\n"
    "  earshot bvh fox.glb --frames 0:1:0.1         how the tree degrades over an animation\n"
    "  earshot bvh fox.glb --frames 0:1:0.1 --plot cost.svg\n"
    "  earshot bvh kitchen.ply --threads 1 --json   machine-readable summary";

std::string footer() {
    std::string text = std::string(kNotes) + "Builders:\n";
    for (const bvh::NamedBuilder& builder : bvh::named_builders()) {
        std::string name(builder.name);
        name.resize(std::max<std::size_t>(name.size(), 16), ' ');
        text += "  " + name + std::string(builder.summary) + "\n";
    }
    return text + kExamples;
}

class BvhCommand : public Command {
public:
    explicit BvhCommand(CLI::App& program)
        : Command(
              program, "bvh", "Size, quality and times of a scene's bounding volume hierarchy") {
        scene_.add_to(app(), "a line for each");
        CLI::Option* frames = app().get_option("--frames");
        add_number(app(),
                   "--rays",
                   rays_,
                   {.min = 0.0},
                   "rays per frame that updates expect; default: 1000000")
            ->needs(frames);
        add_output("--plot", plot_file_, "a picture of steps per ray over the frames, FILE.svg")
            ->needs(frames);
        app().add_option("--builder", builder_, "the builder; default: binned_sah");
        app().footer(footer());
    }

    void run() override {
        const std::vector<double> instants = scene_.times(app());
        const HierarchyOptions options = {.build = {.builder = builder()}, .rays_per_frame = rays_};
        override_simd_target(common().simd);
        const io::LoadedScene loaded = scene_.load();
        Executor executor(static_cast<int>(common().threads));
        const HierarchyReport report = measure_hierarchy(loaded.scene, instants, options, executor);
        if (!plot_file_.empty() && !report.frames.empty()) {
            io::write_whole_file(plot_file_, hierarchy_plot(report));
        }
        if (!common().quiet) {
            print_warnings(loaded.warnings);
        }
        if (common().json) {
            write_output(hierarchy_json(report));
        } else if (!common().quiet) {
            write_output(hierarchy_text(report));
        }
    }

private:
    bvh::Builder builder() {
        const auto named = bvh::builder_named(builder_);
        if (!named) {
            throw wrong_usage(app(), "--builder", "'" + builder_ + "' is none of the builders");
        }
        return named->builder;
    }

    double rays_ = 1e6;
    std::string plot_file_;
    SceneChoice scene_;
    std::string builder_{bvh::named_builders().front().name};
};

}  // namespace

std::unique_ptr<Command> make_bvh_command(CLI::App& program) {
    return std::make_unique<BvhCommand>(program);
}

}  // namespace earshot::cli
