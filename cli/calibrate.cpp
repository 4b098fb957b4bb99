// SPDX-License-Identifier: MIT
#include "earshot/base/simd.h"
#include "earshot/cli/calibration_report.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/emitter_options.h"
#include "earshot/cli/locate_job.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/simulation_choice.h"
#include "earshot/cli/strength_reference.h"
#include "earshot/io/calibration.h"
#include "earshot/io/measured_responses.h"
#include "earshot/io/whole_file.h"
#include "earshot/propagation/least_squares.h"

#include <algorithm>
#include <cstdint>
#include <fnmatch.h>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kFooter =
    "Fits the absorption of the scene's materials, band by band, so that its metrics meet "
    "measured\n"
    "ones. Each coefficient may move as far as values of one construction differ in literature\n"
    "(--spread); a material without data may move anywhere. The report tells which coefficients\n"
    "the measurements themselves tell, and which materials they do not part. Scattering stays\n"
    "but with --fit-scattering.\n"
    "The output is a file of materials: beside the scene as SCENE.materials.json every command\n"
    "reads it. docs/calibrate.md tells the method, and how far to trust it.\n\n"
    "Measurements are recordings named SOURCE__LISTENER.wav, as earshot ir names its responses, "
    "or\n"
    "a table with the columns source, listener, metric, band (hertz), value and, if known, its\n"
    "standard error.\n\n"
    "With --locate positions of sources and listeners and the speed of sound are fitted instead, "
    "to\n"
    "measured arrival times (docs/locate.md): a table with the columns source, listener, surfaces\n"
    "and time in seconds. Surfaces are names of materials or meshes in order, as floor>ceiling, "
    "or\n"
    "direct; without them the path closest in time is taken.\n\n"
    "Examples:\n"
    "  earshot calibrate room.gltf --measured recordings/ -o room.materials.json\n"
    "      EDT, T30 and C80 of the recordings\n"
    "  earshot calibrate room.gltf --measured table.csv --metric t30,c80 -o fitted.json --json\n"
    "      some metrics of a table; everything in numbers\n"
    "  earshot calibrate room.gltf --measured table.csv --unknown 'Curtain*' --keep Glass \\\n"
    "      --spread 0.5 -o fitted.json\n"
    "      what is known of the materials\n"
    "  earshot calibrate room.gltf --measured table.csv --fit-scattering -o fitted.json\n"
    "      scattering too\n"
    "  earshot calibrate room.gltf --locate arrivals.csv --folds 5 -o positions.json\n"
    "      where sources and listeners were, and how well that predicts other arrivals";

class CalibrateCommand : public Command {
public:
    explicit CalibrateCommand(CLI::App& program)
        : Command(program,
                  "calibrate",
                  "Fit the absorption of materials, or positions, to measured responses",
                  {.seed = true}) {
        scene_.add_to(app());
        add_output("-o,--output", output_, "the calibrated materials or positions, FILE.json")
            ->required();
        add_material_options();
        locate_.add_to(app());
        emitters_.add_to(app());
        materials_.add_to(app());
        simulation_.add_to(app());
        app().footer(kFooter);
    }

    void run() override {
        if (locate_.is_chosen() == !measured_.empty()) {
            throw wrong_usage(app(), "earshot calibrate", "give either --measured or --locate");
        }
        if (!propagation::least_squares_available()) {
            throw Error("earshot calibrate",
                        "this build is without Ceres",
                        "install libceres-dev, configure and build again");
        }
        const propagation::Options simulation = simulation_.options(app(), common().seed);
        override_simd_target(common().simd);
        io::LoadedScene loaded = scene_.load();
        materials_.apply(scene_.file(), loaded);
        emitters_.apply(app(), scene_, loaded.scene);
        if (locate_.is_chosen()) {
            locate(loaded, simulation);
        } else {
            fit_materials(loaded, simulation);
        }
    }

private:
    /// The rays' chance must be small beside the errors of measurement.
    static constexpr SimulationChoice::Defaults kDefaults = {
        .order = 3, .rays_error_percent = 1.0, .max_auto_rays = 200000};

    void add_material_options() {
        app()
            .add_option("--measured",
                        measured_,
                        "a folder of recordings SOURCE__LISTENER.wav, or a table FILE.csv")
            ->type_name("DIR|FILE");
        metric_option_ =
            app().add_option("--metric",
                             metrics_,
                             "between commas: edt, t20, t30, c50, c80, d50, ts, g; default: edt, "
                             "t30, c80 of recordings (and g with --reference), all of a table");
        add_number(app(),
                   "--error",
                   error_,
                   {1e-3, 1e3},
                   "standard error of measured values that have none, just-noticeable differences; "
                   "default: 0.5");
        add_number(app(),
                   "--spread",
                   spread_,
                   {1e-3, 1e3},
                   "how far coefficients may be off, a factor of the spread in literature; "
                   "default: 1");
        add_repeatable(app(),
                       "--unknown",
                       unknown_,
                       "'PATTERN': materials of which nothing is known, by a shell pattern of "
                       "their names; those without data always are")
            ->type_name("TEXT");
        add_repeatable(app(), "--keep", kept_, "'PATTERN': materials that keep their coefficients")
            ->type_name("TEXT");
        app().add_flag(
            "--fit-scattering", fit_scattering_, "fit scattering as well, which is kept otherwise");
        add_integer(app(),
                    "--simulations",
                    simulations_,
                    {1, 50},
                    "most simulations of the scene until the coefficients stay; default: 5");
        app().add_flag("--noise-free",
                       noise_free_,
                       "the recordings are computed responses without a noise floor");
        reference_.add_to(app());
    }

    void locate(const io::LoadedScene& loaded, const propagation::Options& simulation) {
        if (!common().quiet) {
            print_warnings(loaded.warnings);
        }
        Executor executor(static_cast<int>(common().threads));
        locate_.run(
            {.scene = loaded.scene,
             .air = simulation.air,
             .time = scene_.times(app()).front(),
             .order = app().get_option("--order")->count() > 0 ? simulation.specular_order : -1,
             .seed = simulation.seed,
             .output = output_,
             .quiet = common().quiet,
             .json = common().json},
            executor);
    }

    void fit_materials(const io::LoadedScene& loaded, const propagation::Options& simulation) {
        propagation::CalibrationOptions options = {
            .simulation = simulation,
            .time = scene_.times(app()).front(),
            .default_error = error_,
            .prior_deviation = spread_,
            .fit_scattering = fit_scattering_,
            .max_simulations = static_cast<int>(simulations_)};
        choose_materials(loaded, options);
        const io::MeasuredMetrics measured = read(loaded.scene, options.simulation.bands);
        if (!common().quiet) {
            print_warnings(loaded.warnings);
            print_warnings(loaded.acoustic_warnings);
            print_warnings(measured.warnings);
        }
        Executor executor(static_cast<int>(common().threads));
        const propagation::CalibrationResult result = [&] {
            ProgressBar progress(common().quiet);
            return propagation::calibrate_materials(
                loaded.scene, measured.values, options, executor, &progress);
        }();
        const io::CalibrationParts parts = {.scene = loaded.scene,
                                            .bands = options.simulation.bands,
                                            .result = result,
                                            .default_materials = loaded.default_materials};
        io::write_whole_file(output_, io::encode_calibrated_materials(parts));
        if (!common().quiet) {
            print_warnings(result.warnings);
        }
        if (common().json) {
            write_output(io::encode_calibration(parts));
        } else if (!common().quiet) {
            write_output(calibration_text(parts));
        }
    }

    io::MeasuredMetrics read(const propagation::Scene& scene, const audio::Bands& bands) const {
        io::MeasuredResponseOptions options = {
            .bands = bands,
            .noise_free = noise_free_,
            .strength_correction_db = reference_.correction_db(bands)};
        const bool has_metrics = metric_option_->count() > 0;
        options.kinds = io::parse_metric_keys(has_metrics                      ? metrics_
                                              : options.strength_correction_db ? "edt,t30,c80,g"
                                                                               : "edt,t30,c80");
        return io::read_measured(measured_, scene, options, has_metrics);
    }

    void choose_materials(const io::LoadedScene& loaded,
                          propagation::CalibrationOptions& options) const {
        options.unknown_materials = loaded.default_materials;
        const auto add = [&](const std::vector<std::string>& patterns,
                             const char* option,
                             std::vector<std::uint32_t>& materials) {
            for (const std::string& pattern : patterns) {
                bool has_match = false;
                for (std::uint32_t i = 0; i < loaded.scene.materials.size(); ++i) {
                    if (fnmatch(pattern.c_str(), loaded.scene.materials[i].name.c_str(), 0) == 0) {
                        materials.push_back(i);
                        has_match = true;
                    }
                }
                if (!has_match) {
                    throw Error(option,
                                "no material of the scene matches '" + pattern + "'",
                                "earshot check lists its materials");
                }
            }
        };
        add(unknown_, "--unknown", options.unknown_materials);
        add(kept_, "--keep", options.fixed_materials);
    }

    SceneChoice scene_;
    EmitterOptions emitters_;
    MaterialOptions materials_;
    SimulationChoice simulation_{kDefaults};
    StrengthReference reference_;
    LocateJob locate_;
    std::string measured_, output_, metrics_;
    double error_ = 0.5, spread_ = 1.0;
    std::vector<std::string> unknown_, kept_;
    std::int64_t simulations_ = 5;
    bool noise_free_ = false, fit_scattering_ = false;
    CLI::Option* metric_option_ = nullptr;  // owned by the program
};

}  // namespace

std::unique_ptr<Command> make_calibrate_command(CLI::App& program) {
    return std::make_unique<CalibrateCommand>(program);
}

}  // namespace earshot::cli
