// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/emitter_options.h"
#include "earshot/cli/format_choice.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/pvs_coverage.h"
#include "earshot/cli/report_output.h"
#include "earshot/cli/response_job.h"
#include "earshot/cli/response_summary.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/simulation_choice.h"
#include "earshot/cli/speech_options.h"
#include "earshot/cli/values.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/visibility_file.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kReportName = "report.html";

constexpr const char* kFooter =
    "Writes SOURCE__LISTENER.wav (32-bit float) per pair, paths.json and metrics.json, and prints\n"
    "a table of metrics with their standard errors.\n"
    "Reflections up to --order are exact; rays add later and scattered sound.\n\n"
    "Examples:\n"
    "  earshot ir scenes/concert_hall.gltf -o out\n"
    "      every source and listener of the scene, reflections up to order 4\n"
    "  earshot ir room.obj --source 1,1.5,2 --listener seat=4,1.2,3 --order 6 -o out\n"
    "      with a source and a listener at given points, in addition to those of the scene\n"
    "  earshot ir scenes/concert_hall.gltf --format binaural --look-at 0,1.5,0 -o out\n"
    "      binaural responses of listeners that face a point\n"
    "  earshot ir scenes/door.gltf --frames 0:2:0.1 -o out\n"
    "      one response per instant of an animation\n"
    "  earshot ir scenes/classroom.gltf --sensitivity -o out\n"
    "      which surface to treat: what each material's absorption changes\n\n"
    "Binaural responses without --hrtf use measurements of a KEMAR manikin by Bill Gardner and\n"
    "Keith Martin, Copyright 1994 by the MIT Media Laboratory. It is provided free with no\n"
    "restrictions on use, provided the authors are cited when the data is used in any research or\n"
    "commercial application.";

class IrCommand : public Command {
public:
    explicit IrCommand(CLI::App& program)
        : Command(program,
                  "ir",
                  "Impulse responses for every source and listener of a scene",
                  {.seed = true}) {
        scene_.add_to(app(), "a response for each");
        app()
            .add_option("-o,--output", directory_, "folder for the results; created if missing")
            ->required();
        app()
            .add_option("--plan",
                        plan_,
                        "also draw a plan with labels of sources, listeners and the surfaces that "
                        "reflect first; .svg")
            ->type_name("FILE");
        emitters_.add_to(app());
        materials_.add_to(app());
        simulation_.add_paths_to(app());
        add_tracing_options();
        add_visibility_options();
        simulation_.add_rays_to(app());
        app().add_flag("--histograms",
                       writes_histograms_,
                       "also write the energy of late sound over time, with standard errors, to "
                       "histograms.json");
        add_format_options();
        add_sound_options();
        add_metrics_options();
        app().footer(kFooter);
    }

    void run() override {
        const std::vector<double> instants = scene_.times(app());
        propagation::Options simulation = simulation_.options(app(), common().seed);
        propagation::ResponseFormat format = response_format();
        if (!plan_.empty() && !plan_.ends_with(".svg")) {
            throw wrong_usage(app(), "--plan", "'" + plan_ + "' does not end in .svg");
        }
        const std::vector<io::ReportLimit> limits = limits_.limits(app());
        if (writes_report_) {
            require_report(kReportName);
        }
        override_simd_target(common().simd);

        io::LoadedScene loaded = scene_.load();
        materials_.apply(scene_.file(), loaded);
        emitters_.apply(app(), scene_, loaded.scene);
        if (!visibility_file_.empty()) {
            visible_sets_.emplace(io::read_visible_sets(visibility_file_));
            const Warnings uncovered =
                uncovered_sources(loaded.scene, *visible_sets_, visibility_file_, instants);
            loaded.warnings.insert(loaded.warnings.end(), uncovered.begin(), uncovered.end());
        }
        const ResponseJob job = {.scene = loaded.scene,
                                 .simulation = with_own_options(std::move(simulation)),
                                 .format = std::move(format),
                                 .write_sofa = writes_sofa_,
                                 .write_histograms = writes_histograms_,
                                 .plan = plan_,
                                 .write_sensitivity = writes_sensitivity_,
                                 .keep_texts = writes_report_,
                                 .check_visibility = checks_visibility_,
                                 .times = instants,
                                 .is_sequence = scene_.is_sequence(),
                                 .directory = directory_};
        Executor executor(static_cast<int>(common().threads));
        ResponseSummary summary;
        {
            ProgressBar progress(common().quiet);
            summary = run_response_job(job, executor, progress);
        }
        if (!common().quiet || writes_report_) {
            warn_of_doubtful_model(instants.front(), summary, loaded);
        }
        if (writes_report_) {
            make_page(loaded, instants.front(), limits, summary);
        }
        // Not before the work is done: what fails says one line and no more.
        if (!common().quiet) {
            print_warnings(loaded.warnings);
            print_warnings(io::warnings_of_acoustics(loaded));
            print_notes(summary.notes);
        }
        if (common().json) {
            write_output(summary_json(job, summary));
        } else if (!common().quiet) {
            write_output(summary_text(job, summary));
        }
    }

private:
    void add_tracing_options() {
        add_integer(app(),
                    "--diffraction",
                    diffraction_,
                    {0, propagation::kMaxDiffraction},
                    "maximum number of edges that a path bends round: 1, beside its reflections, "
                    "or 2 in turn without any; in scenes of many edges give --order 2, as more "
                    "reflections take long and much memory");
        app()
            .add_option("--mode",
                        mode_,
                        "complete (finds every path) or sampled (faster, may miss paths at edges)")
            ->check(CLI::IsMember({"complete", "sampled"}))
            ->capture_default_str();
        add_integer(app(),
                    "--resolution",
                    resolution_,
                    {0, 1024},
                    "sub-frusta along a cube face around the source; 0: the default");
        add_number(app(),
                   "--max-length",
                   max_length_,
                   {0.0, 1e9},
                   "maximum length of a path, metres; 0: no limit");
        add_number(app(),
                   "--min-level",
                   min_level_db_,
                   {-1000.0, 1000.0},
                   "minimum level of a path in its loudest band, decibels re the source at 1 m");
        add_number(app(),
                   "--min-diffraction-level",
                   min_diffraction_level_db_,
                   {-1000.0, 1000.0},
                   "minimum level of a path round an edge in its loudest band, decibels re the "
                   "direct sound if nothing were in the way; default: -40");
    }

    void add_visibility_options() {
        CLI::Option* file =
            app()
                .add_option(
                    "--visibility",
                    visibility_file_,
                    "skip paths whose first reflection is not in the visible set of the "
                    "source's cell; a file of earshot pvs build, whose sets may be incomplete")
                ->type_name("FILE");
        app()
            .add_flag("--check-visibility",
                      checks_visibility_,
                      "also search without the file and report how many paths it loses")
            ->needs(file);
    }

    void add_format_options() {
        format_.add_to(app());
        app().add_flag("--sofa", writes_sofa_, "also write all responses to responses.sofa");
        CLI::Option* report =
            app().add_flag("--report",
                           writes_report_,
                           "also write report.html, a page for the browser that shows the results");
        limits_.add_to(app())->needs(report);
    }

    void add_sound_options() {
        add_integer(app(), "--sample-rate", sample_rate_hz_, {1000, 768000}, "sample rate, hertz");
        add_number(app(),
                   "--length",
                   length_,
                   {0.0, 3600.0},
                   "length of a response, seconds; 0: until the last sound has arrived");
        simulation_.add_sound_to(app());
    }

    void add_metrics_options() {
        app().add_flag("--no-metrics",
                       no_metrics_,
                       "write no metrics.json; saves time where there are many pairs");
        speech_.add_to(app(), "1 m in front of the talker");
        app().add_flag("--sensitivity",
                       writes_sensitivity_,
                       "also write which surfaces matter to sensitivity.json: the energy that each "
                       "material reflects and absorbs before and after 80 ms, and the derivatives "
                       "of the metrics by its absorption");
    }

    /// Options of a simulation with those that no other command has.
    propagation::Options with_own_options(propagation::Options options) const {
        options.mode = mode_ == "sampled" ? frustum::Mode::sampled : frustum::Mode::complete;
        options.resolution = static_cast<int>(resolution_);
        options.diffraction = static_cast<int>(diffraction_);
        options.max_length =
            max_length_ > 0.0 ? max_length_ : std::numeric_limits<double>::infinity();
        options.min_level_db = min_level_db_;
        options.min_diffraction_level_db = min_diffraction_level_db_;
        options.late_length = length_;
        options.late_directions = !format_.is_mono();
        options.report_materials = writes_sensitivity_ || writes_report_;
        options.keep_traces = scene_.is_sequence();
        options.visible_sets = visible_sets_ ? &*visible_sets_ : nullptr;
        return options;
    }

    propagation::ResponseFormat response_format() {
        propagation::ResponseFormat format = {.sample_rate = static_cast<double>(sample_rate_hz_),
                                              .length = length_,
                                              .seed = static_cast<std::uint64_t>(common().seed),
                                              .report_metrics = !no_metrics_,
                                              .speech = speech_.conditions(app())};
        format_.apply(app(), format);
        return format;
    }

    /// A unit that is not meant, or a listener in a table, is no error, but hardly what was wanted.
    void warn_of_doubtful_model(double time,
                                const ResponseSummary& summary,
                                io::LoadedScene& loaded) const {
        const propagation::Scene& scene = loaded.scene;
        const io::FileFrame frame = scene_.frame();
        const propagation::ReadAs read_as{.metres_per_unit = frame.metres_per_unit,
                                          .z_is_up = frame.up == io::UpAxis::z};
        const bool has_unit_option = !io::is_gltf(scene_.file());
        if (const auto proposal = propagation::propose_unit(summary.size,
                                                            summary.visible_volume,
                                                            read_as,
                                                            propagation::model_kind(scene, time))) {
            loaded.acoustic_warnings.push_back(
                {scene.name, propagation::unit_warning(*proposal, summary.size, has_unit_option)});
        }
        const Warnings misplaced = propagation::misplaced_emitters(scene, time);
        loaded.acoustic_warnings.insert(
            loaded.acoustic_warnings.end(), misplaced.begin(), misplaced.end());
    }

    /// report.html beside the other results.
    void make_page(const io::LoadedScene& loaded,
                   double time,
                   const std::vector<io::ReportLimit>& limits,
                   ResponseSummary& summary) const {
        io::RoomReport report{
            .title = std::filesystem::path(loaded.scene.name).stem().string(),
            .provenance = {.version = program_version(),
                           .command = command_line(),
                           .seed = static_cast<std::uint64_t>(common().seed),
                           .files = {loaded.scene.name}},
            .metrics = {"metrics.json", std::move(summary.texts.metrics)},
            .paths = {"paths.json", std::move(summary.texts.paths)},
            .histograms = {"histograms.json", std::move(summary.texts.histograms)},
            .sensitivity = {"sensitivity.json", std::move(summary.texts.sensitivity)},
            .scene = &loaded.scene,
            .time = time,
            .default_materials = loaded.default_materials,
            .limits = limits,
            .warnings = loaded.warnings};
        for (const Warnings& more : {io::warnings_of_acoustics(loaded), summary.notes}) {
            report.warnings.insert(report.warnings.end(), more.begin(), more.end());
        }
        summary.files.push_back(std::filesystem::path(directory_) / kReportName);
        write_report(summary.files.back(), io::encode_room_report(report));
    }

    static void print_notes(const Warnings& notes) {
        constexpr std::size_t kMaxNotes = 8;
        Warnings shown(notes.begin(),
                       notes.begin() + static_cast<long>(std::min(notes.size(), kMaxNotes)));
        if (notes.size() > kMaxNotes) {
            shown.push_back({"...", std::to_string(notes.size() - kMaxNotes) + " more"});
        }
        print_warnings(shown);
    }

    SceneChoice scene_;
    std::string directory_, plan_, mode_ = "complete";
    FormatChoice format_;
    EmitterOptions emitters_;
    MaterialOptions materials_;
    SimulationChoice simulation_;
    bool writes_sofa_ = false;
    bool writes_histograms_ = false;
    bool writes_sensitivity_ = false;
    bool writes_report_ = false;
    LimitOption limits_;
    std::string visibility_file_;
    std::optional<visibility::VisibleSets> visible_sets_;
    bool checks_visibility_ = false;
    double max_length_ = 0.0;
    double min_level_db_ = -std::numeric_limits<double>::infinity();
    double min_diffraction_level_db_ = propagation::Options{}.min_diffraction_level_db;
    bool no_metrics_ = false;
    SpeechOptions speech_;
    std::int64_t resolution_ = 0;
    std::int64_t diffraction_ = 0;
    std::int64_t sample_rate_hz_ = 48000;
    double length_ = 0.0;
};

}  // namespace

std::unique_ptr<Command> make_ir_command(CLI::App& program) {
    return std::make_unique<IrCommand>(program);
}

}  // namespace earshot::cli
