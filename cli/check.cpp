// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/cli/check_picture.h"
#include "earshot/cli/check_report.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/emitter_options.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/io/scene_glb.h"
#include "earshot/io/whole_file.h"
#include "earshot/propagation/model_mending.h"

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kFooter =
    "Says what a model needs before its results are trusted: unit and up axis, sources and\n"
    "listeners in solids, outside or in sealed rooms, leaks with place and size, reversed and\n"
    "doubled faces, materials without data, and the time that earshot ir will take. The gravest\n"
    "findings stand first. docs/check.md tells how each is found and how sure it is.\n\n"
    "Exit status: 0 clean, 1 unusable (or the check failed), 2 a usage error, 3 questionable.\n\n"
    "Examples:\n"
    "  earshot check scenes/classroom.gltf\n"
    "      the findings, the air, the materials and the forecast of time\n"
    "  earshot check room.obj --units in --up z --source 40,60,50 --listener 200,60,50\n"
    "      a model without sources and listeners, in its own unit and axes\n"
    "  earshot check room.obj --json > report.json\n"
    "      everything with coordinates\n"
    "  earshot check room.obj --fix -o mended.glb --image findings.svg\n"
    "      a copy without doubled faces, with fronts to the air and small holes filled; a plan";

class CheckCommand : public Command {
public:
    explicit CheckCommand(CLI::App& program)
        : Command(program,
                  "check",
                  "What a model needs before it is trusted: leaks, units, faces, materials",
                  {.seed = true}) {
        scene_.add_to(app());
        emitters_.add_to(app());
        materials_.add_to(app());
        add_number(app(),
                   "--crack",
                   lambda_,
                   {0.0, 1.0},
                   "the share of a room's surface below which an opening into a solid counts as a "
                   "crack; default: 0.01");
        add_integer(
            app(),
            "--rays",
            max_rays_,
            {1000, 1000000000},
            "at most so many rays look for the air, and as many for leaks; fewer reach less "
            "of a large model; default: 20000000");
        add_number(app(),
                   "--forecast",
                   forecast_seconds_,
                   {0.0, 3600.0},
                   "seconds to spend on the forecast of time; 0: none; default: 2");
        CLI::Option* fix = app().add_flag(
            "--fix",
            fix_,
            "write a mended copy: vertices welded, fronts turned to the air, doubled faces and "
            "what is proved out of reach removed, small holes filled; lists every change. A scene "
            "that moves is copied as it is at --time, and refused without");
        CLI::Option* output =
            add_output("-o,--output", output_, "the mended copy, FILE.glb")->needs(fix);
        fix->needs(output);
        add_number(app(),
                   "--fill",
                   max_hole_area_,
                   {0.0, 1e6},
                   "largest hole that --fix fills, square metres; default: 0.05")
            ->needs(fix);
        add_output("--image", picture_file_, "a plan and an elevation with the findings, FILE.svg");
        app().footer(kFooter);
    }

    void run() override {
        override_simd_target(common().simd);
        io::LoadedScene loaded = scene_.load();
        if (fix_ && !is_one_instant()) {
            propagation::require_still(loaded.scene);
        }
        materials_.apply(scene_.file(), loaded);
        constexpr bool kRequireEmitters = false;
        emitters_.apply(app(), scene_, loaded.scene, kRequireEmitters);
        const io::FileFrame frame = scene_.frame();
        Executor executor(static_cast<int>(common().threads));
        propagation::ModelReport report;
        {
            ProgressBar progress(common().quiet);
            report = propagation::check_model(loaded.scene,
                                              {.read_as = {.metres_per_unit = frame.metres_per_unit,
                                                           .z_is_up = frame.up == io::UpAxis::z},
                                               .default_materials = loaded.default_materials,
                                               .materials_by_name = loaded.materials_by_name,
                                               .time = scene_.times(app()).front(),
                                               .seed = static_cast<std::uint64_t>(common().seed),
                                               .max_rays = static_cast<std::uint64_t>(max_rays_),
                                               .lambda = lambda_,
                                               .forecast_seconds = forecast_seconds_,
                                               .progress = &progress},
                                              executor);
        }
        const std::vector<propagation::Finding> findings =
            propagation::model_findings(loaded.scene, report, !io::is_gltf(scene_.file()));
        io::ModelReportParts parts{
            .scene = loaded.scene, .report = report, .findings = findings, .unit = scene_.unit()};
        std::optional<propagation::MendedModel> mended;
        if (fix_) {
            mended.emplace(write_mended(loaded.scene, report));
            parts.mending = &mended->report;
        }
        if (!picture_file_.empty()) {
            io::write_whole_file(picture_file_,
                                 check_picture(loaded.scene, scene_.times(app()).front(), report));
        }
        if (!common().quiet) {
            print_warnings(loaded.warnings);
            print_warnings(loaded.acoustic_warnings);
        }
        if (common().json) {
            write_output(io::encode_model_report(parts));
        } else if (!common().quiet) {
            write_output(check_text(parts));
        }
        set_exit_status(check_status(propagation::gravest(findings)));
    }

private:
    /// Whether the user asks for the scene as it is at an instant.
    bool is_one_instant() { return app().count("--time") > 0; }

    /// Writes the mended copy, never over the input.
    propagation::MendedModel write_mended(const propagation::Scene& scene,
                                          const propagation::ModelReport& report) {
        std::error_code failure;
        if (std::filesystem::equivalent(output_, scene_.file(), failure)) {
            throw Error(output_, "is the model itself, which stays as it is", "choose another -o");
        }
        for (const propagation::Emitter& source : scene.sources) {
            if (!source.directivity.is_omnidirectional()) {
                print_warnings({{scene.name,
                                 "the directivity of source \"" + source.name +
                                     "\" is not written to the mended copy; give it with "
                                     "--directivity"}});
            }
        }
        propagation::MendedModel mended =
            propagation::mend_model(scene,
                                    report,
                                    {.max_hole_area = max_hole_area_,
                                     .time = scene_.times(app()).front(),
                                     .freeze = is_one_instant()});
        io::write_whole_file(output_, io::encode_glb(mended.scene));
        return mended;
    }

    SceneChoice scene_;
    EmitterOptions emitters_;
    MaterialOptions materials_;
    std::int64_t max_rays_ = 20'000'000;
    double lambda_ = 0.01;
    double forecast_seconds_ = 2.0;
    bool fix_ = false;
    double max_hole_area_ = 0.05;
    std::string output_, picture_file_;
};

}  // namespace

std::unique_ptr<Command> make_check_command(CLI::App& program) {
    return std::make_unique<CheckCommand>(program);
}

}  // namespace earshot::cli
