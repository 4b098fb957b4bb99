// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/emitter_options.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/simplify_report.h"
#include "earshot/io/material_assignments.h"
#include "earshot/io/scene_glb.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kFooter =
    "Writes a copy of a model with fewer triangles for sound. Coplanar faces of a material become\n"
    "one, then edges collapse within --distance and --angle; the distance is measured afterwards,\n"
    "both ways, and proved. Small objects become boxes. Absorption areas stay: materials whose\n"
    "surface shrinks absorb more, and scatter by the detail that is gone. docs/simplify.md tells\n"
    "how. The model itself stays as it is.\n\n"
    "With sources and listeners, both models are simulated and T30 and C80 compared, which takes\n"
    "the time of two runs of earshot ir; --no-compare leaves that out.\n\n"
    "Examples:\n"
    "  earshot simplify room.glb -o simple.glb\n"
    "      within 1 cm\n"
    "  earshot simplify kitchen.ply -o simple.glb --distance 0.02 --json > report.json\n"
    "      within 2 cm; the report as JSON\n"
    "  earshot simplify room.glb -o simple.glb --max-frequency 1000\n"
    "      what sound of up to 1 kHz tells apart: 4 cm, and boxes for objects of up to 17 cm\n"
    "  earshot simplify room.glb -o simple.glb --objects 0.5 --no-compare\n"
    "      within 1 cm, and boxes for all objects of up to half a metre";

constexpr double kDegree = 0.017453292519943295;

class SimplifyCommand : public Command {
public:
    explicit SimplifyCommand(CLI::App& program)
        : Command(program,
                  "simplify",
                  "Fewer triangles for sound, within a stated distance and angle",
                  {.seed = true}) {
        scene_.add_to(app());
        add_output("-o,--output", output_, "the simplified copy, FILE.glb")->required();
        CLI::Option* distance =
            add_number(app(),
                       "--distance",
                       distance_,
                       {1e-4, 1e3},
                       "metres between the surfaces before and after, at most; default: 0.01");
        add_number(app(),
                   "--max-frequency",
                   max_frequency_,
                   {1.0, 100000.0},
                   "hertz: the highest frequency that shall see the detail; a distance of an "
                   "eighth of its wavelength, boxes for objects of up to a half")
            ->excludes(distance);
        add_number(app(),
                   "--angle",
                   angle_deg_,
                   {0.0, 180.0},
                   "degrees: the opening of the cone that holds the normals of all that a triangle "
                   "replaces; default: 180");
        objects_option_ =
            add_number(app(),
                       "--objects",
                       object_size_,
                       {0.0, 1e3},
                       "metres: connected parts of up to this extent become boxes, whatever "
                       "their distance; default: those whose boxes keep the distance");
        app().add_flag("--no-compare", no_compare_, "do not simulate and compare both models");
        add_integer(app(),
                    "--order",
                    order_,
                    {0, 20},
                    "highest order of the reflections that are compared; default: 3");
        add_integer(app(),
                    "--rays",
                    rays_,
                    {0, 100000000},
                    "late rays at most, until the standard error of T30 is below 2 %; default: "
                    "1000000");
        emitters_.add_to(app());
        materials_.add_to(app());
        app().footer(kFooter);
    }

    void run() override {
        override_simd_target(common().simd);
        io::LoadedScene loaded = scene_.load();
        materials_.apply(scene_.file(), loaded);
        constexpr bool kRequireEmitters = false;
        emitters_.apply(app(), scene_, loaded.scene, kRequireEmitters);
        require_other_file(scene_.file());
        warn_of_directivities(loaded.scene);
        Executor executor(static_cast<int>(common().threads));
        std::optional<ProgressBar> bar(std::in_place, common().quiet);
        propagation::SimplificationOptions options = simplification_options();
        options.progress = &*bar;
        const auto start = std::chrono::steady_clock::now();
        const propagation::SimplifiedModel model =
            propagation::simplify_model(loaded.scene, options, executor);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        write(model);
        std::optional<propagation::ModelComparison> comparison;
        if (!no_compare_ && !loaded.scene.sources.empty() && !loaded.scene.listeners.empty()) {
            comparison = compare(loaded.scene, model.scene, executor, *bar);
        }
        bar.reset();
        print({.model = model,
               .options = options,
               .comparison = comparison ? &*comparison : nullptr,
               .seconds = seconds.count()},
              loaded);
    }

private:
    propagation::SimplificationOptions simplification_options() const {
        propagation::SimplificationOptions options{.max_distance = distance_};
        if (max_frequency_ > 0.0) {
            options = propagation::options_for_frequency(
                max_frequency_, propagation::speed_of_sound(propagation::Air{}));
        }
        options.max_angle =
            std::min(kDegree * angle_deg_, propagation::SimplificationOptions{}.max_angle);
        if (objects_option_->count() > 0) {
            options.max_object_size = object_size_;
            options.boxes = object_size_ > 0.0;
        }
        return options;
    }

    void require_other_file(const std::string& file) const {
        std::error_code failure;
        if (std::filesystem::equivalent(output_, file, failure)) {
            throw Error(output_, "is the model itself, which stays as it is", "choose another -o");
        }
    }

    static void warn_of_directivities(const propagation::Scene& scene) {
        for (const propagation::Emitter& source : scene.sources) {
            if (!source.directivity.is_omnidirectional()) {
                print_warnings({{scene.name,
                                 "the directivity of source \"" + source.name +
                                     "\" is not written to the simplified copy; give it with "
                                     "--directivity"}});
            }
        }
    }

    /// The copy, and beside it the materials that have new data.
    void write(const propagation::SimplifiedModel& model) const {
        io::write_whole_file(output_, io::encode_glb(model.scene));
        const std::vector<propagation::Material> changed = changed_materials(model);
        if (!changed.empty()) {
            io::write_whole_file(io::material_assignments_file(output_),
                                 io::encode_materials(changed));
        }
    }

    /// A name that stands several times says nothing in a table: the copy itself has all data.
    static std::vector<propagation::Material> changed_materials(
        const propagation::SimplifiedModel& model) {
        std::vector<propagation::Material> changed;
        const std::vector<propagation::Material>& all = model.scene.materials;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const auto has_name = [&](const propagation::Material& other) {
                return other.name == all[i].name;
            };
            if (model.report.materials[i].has_new_data &&
                std::count_if(all.begin(), all.end(), has_name) == 1) {
                changed.push_back(all[i]);
            }
        }
        return changed;
    }

    propagation::ModelComparison compare(const propagation::Scene& before,
                                         const propagation::Scene& after,
                                         Executor& executor,
                                         Progress& progress) const {
        constexpr double kMaxError = 0.02;  // of T30, as for earshot ir
        return propagation::compare_models(before,
                                           after,
                                           {.specular_order = static_cast<int>(order_),
                                            .rays = static_cast<std::size_t>(rays_),
                                            .max_error = kMaxError,
                                            .seed = static_cast<std::uint64_t>(common().seed)},
                                           executor,
                                           &progress);
    }

    void print(const io::SimplificationReportParts& parts, const io::LoadedScene& loaded) const {
        if (!common().quiet) {
            print_warnings(loaded.warnings);
            print_warnings(loaded.acoustic_warnings);
        }
        if (common().json) {
            write_output(io::encode_simplification_report(parts));
        } else if (!common().quiet) {
            write_output(simplify_text(parts));
        }
    }

    SceneChoice scene_;
    EmitterOptions emitters_;
    MaterialOptions materials_;
    double distance_ = 0.01;
    double max_frequency_ = 0.0;
    double angle_deg_ = 180.0;
    double object_size_ = 0.0;
    CLI::Option* objects_option_ = nullptr;
    std::int64_t order_ = 3;
    std::int64_t rays_ = 1000000;
    bool no_compare_ = false;
    std::string output_;
};

}  // namespace

std::unique_ptr<Command> make_simplify_command(CLI::App& program) {
    return std::make_unique<SimplifyCommand>(program);
}

}  // namespace earshot::cli
