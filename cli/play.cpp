// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/simd.h"
#include "earshot/cli/audio_device.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/emitter_options.h"
#include "earshot/cli/format_choice.h"
#include "earshot/cli/material_options.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/recording.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/cli/scene_player.h"
#include "earshot/cli/simulation_choice.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/sound_file.h"
#include "earshot/io/sound_signal.h"
#include "earshot/io/whole_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

using propagation::EngineOptions;
using propagation::EngineStatistics;

constexpr const char* kFooter =
    "Sources play mono recordings while they, the listener and surfaces move, by the scene's\n"
    "animation or by --path-of. Paths are found again as things move; every one is a delay that\n"
    "follows its length, so that motion is heard at its pitch.\n"
    "Without -o the sound goes to an audio device as it is computed. With -o it goes to a file, "
    "as\n"
    "fast as the machine can, and does not depend on that.\n\n"
    "Examples:\n"
    "  earshot play hall.gltf --sound stage=violin.wav --format binaural\n"
    "  earshot play street.glb --sound car=horn.wav --path-of car=way.csv -o passing.wav\n"
    "  earshot play --list-devices";

class PlayCommand : public Command {
public:
    explicit PlayCommand(CLI::App& program)
        : Command(program,
                  "play",
                  "Play a scene that moves in real time, or faster into a file",
                  {.seed = true}),
          simulation_choice_({.order = 3}) {
        app().add_option("SCENE", file_, "a .gltf, .glb, .obj, .ply, .stl or .off file");
        add_repeatable(app(),
                       "--sound",
                       sounds_,
                       "[NAME=]FILE: the mono recording that a source (the only one) plays")
            ->type_name("[NAME=]FILE");
        ways_.add_to(app());
        app()
            .add_option("--to", to_, "name of the listener, if there are several")
            ->type_name("NAME");
        add_output("-o,--output", output_, "write a .wav, .flac or .ogg file in place of playing");
        app()
            .add_option(
                "--device", device_, "part of the name of an audio device; default: the system's")
            ->type_name("NAME");
        app().add_flag("--list-devices", list_devices_, "list the audio devices and end");
        seconds_option_ =
            add_number(app(),
                       "--seconds",
                       seconds_,
                       {0.0, 86400.0},
                       "length of the sound; default: that of the longest recording and 2 seconds");
        add_number(app(), "--gain", gain_db_, {-200.0, 200.0}, "level of what is heard, decibels");
        add_integer(app(), "--sample-rate", sample_rate_, {8000, 192000}, "hertz");
        add_integer(app(),
                    "--block",
                    block_,
                    {32, 4096},
                    "samples that are rendered at once, a power of two");
        add_number(app(),
                   "--update-interval",
                   update_interval_,
                   {0.005, 10.0},
                   "seconds from one search for paths to the next");
        scene_choice_.add_reading_to(app());
        emitters_.add_to(app());
        materials_.add_to(app());
        simulation_choice_.add_paths_to(app());
        add_integer(
            app(),
            "--rays",
            rays_,
            {0, 100000},
            "late rays of a source whenever its late sound is traced anew; 0: no late sound");
        simulation_choice_.add_sound_to(app());
        format_choice_.add_to(app());
        app().footer(kFooter);
    }

    void run() override {
        if (list_devices_) {
            for (const std::string& name : AudioDevice::names()) {
                write_output(on_one_line(name) + "\n");
            }
            return;
        }
        if (file_.empty()) {
            throw wrong_usage(app(), "SCENE", "is missing");
        }
        if (sounds_.empty()) {
            throw wrong_usage(app(), "--sound", "is missing: no source plays anything");
        }
        const auto format = output_.empty() ? io::SoundFormat::wav : io::sound_format_of(output_);
        if (!std::has_single_bit(static_cast<std::uint64_t>(block_))) {
            throw wrong_usage(app(), "--block", std::to_string(block_) + " is no power of two");
        }
        override_simd_target(common().simd);
        Executor executor(static_cast<int>(common().threads));
        const EngineOptions options = engine_options();
        ScenePlayer player(programme(), options, executor);
        ProgressBar progress(common().quiet);
        std::uint64_t underflows = 0;
        if (output_.empty()) {
            underflows = player.play(device_, progress);
        } else {
            write(player.render(progress), format);
        }
        tell(player.statistics(), underflows);
    }

private:
    EngineOptions engine_options() {
        EngineOptions options;
        options.simulation = simulation_choice_.options(app(), common().seed);
        options.simulation.rays = static_cast<std::size_t>(rays_);
        options.simulation.max_error = 0.0;
        propagation::ResponseFormat format;
        format_choice_.apply(app(), format);
        options.channels = format.channels;
        options.hrir_set = std::move(format.hrir_set);
        if (options.channels == propagation::Channels::ambisonic) {
            options.ambisonic_order = format.ambisonic_order;
        }
        options.sample_rate = static_cast<double>(sample_rate_);
        options.block = static_cast<std::size_t>(block_);
        options.update_interval = update_interval_;
        options.motion_delay = std::max(options.motion_delay, 2.0 * update_interval_);
        options.seed = static_cast<std::uint64_t>(common().seed);
        return options;
    }

    Programme programme() {
        scene_choice_.set_file(file_);
        Programme programme;
        programme.start = scene_choice_.times(app()).front();
        io::LoadedScene loaded = scene_choice_.load();
        materials_.apply(file_, loaded);
        emitters_.apply(app(), scene_choice_, loaded.scene);
        warnings_ = loaded.warnings;
        const Warnings acoustic = io::warnings_of_acoustics(loaded);
        warnings_.insert(warnings_.end(), acoustic.begin(), acoustic.end());
        programme.ways = ways_.read(app(), scene_choice_, loaded.scene);
        std::vector<propagation::Emitter>& listeners = loaded.scene.listeners;
        listeners = {listeners[find_emitter(
            file_, listeners, {.role = "listener", .option = "--to", .name = to_})]};
        programme.recordings = read_recordings(loaded.scene.sources);
        programme.scene = std::move(loaded.scene);
        std::size_t longest = 0;
        for (const std::vector<float>& recording : programme.recordings) {
            longest = std::max(longest, recording.size());
        }
        constexpr double kTail = 2.0;
        const auto rate = static_cast<double>(sample_rate_);
        const double seconds =
            seconds_option_->count() > 0 ? seconds_ : static_cast<double>(longest) / rate + kTail;
        programme.frames = static_cast<std::size_t>(std::llround(seconds * rate));
        return programme;
    }

    /// By source.
    std::vector<std::vector<float>> read_recordings(
        const std::vector<propagation::Emitter>& sources) const {
        std::vector<std::vector<float>> recordings(sources.size());
        const double gain = math::pow10(gain_db_ / 20.0);
        for (const std::string& text : sounds_) {
            const std::size_t equals = text.find('=');
            const bool has_name = equals != std::string::npos;
            const std::string file = has_name ? text.substr(equals + 1) : text;
            std::vector<float>& recording =
                recordings[find_emitter(file_,
                                        sources,
                                        {.role = "source",
                                         .option = "--sound NAME=FILE",
                                         .name = has_name ? text.substr(0, equals) : ""})];
            if (!recording.empty()) {
                throw Error("--sound", "two recordings are for one source");
            }
            for (const double sample : read_mono(file)) {
                recording.push_back(static_cast<float>(gain * sample));
            }
        }
        return recordings;
    }

    std::vector<double> read_mono(const std::string& file) const {
        audio::Signal signal = read_signal(file);
        require_mono(file, signal);
        audio::resample_to(sample_rate_, signal);
        return std::move(signal.channels.front());
    }

    void write(const audio::Signal& signal, io::SoundFormat format) const {
        const io::Sound sound = io::sound_of(signal);
        io::write_whole_file(output_, io::encode_sound(sound, format));
        const std::size_t clipped = io::count_beyond_full_scale(sound);
        if (clipped > 0 && format != io::SoundFormat::wav) {
            print_warnings({{output_,
                             std::to_string(clipped) +
                                 " samples exceed full scale and are clipped; use --gain"}});
        }
    }

    void tell(const EngineStatistics& done, std::uint64_t underflows) const {
        if (common().json) {
            write_output(json_of(done, underflows).dump(1) + "\n");
        } else if (!common().quiet) {
            std::ostringstream text;
            text << (output_.empty() ? file_ : output_) << ": " << done.updates << " updates of "
                 << done.median_update_milliseconds << " ms (median; at most "
                 << done.max_update_milliseconds << "), " << done.paths << " paths at the end";
            if (output_.empty()) {
                text << ", load of the audio thread " << 100.0 * done.load_quantile(0.5)
                     << " % (median; 99.9 % of blocks at most " << 100.0 * done.load_quantile(0.999)
                     << " %), " << underflows << " times too late";
            }
            write_output(text.str() + "\n");
        }
        warn(done);
    }

    nlohmann::ordered_json json_of(const EngineStatistics& done, std::uint64_t underflows) const {
        nlohmann::ordered_json json = {{"version", 1},
                                       {"updates", done.updates},
                                       {"failed_updates", done.failed_updates},
                                       {"paths", done.paths},
                                       {"dropped_paths", done.dropped_paths},
                                       {"blocks", done.blocks},
                                       {"late_snapshots", done.late_snapshots}};
        // What depends on the machine is told of the machine's own time alone.
        if (output_.empty()) {
            json["update_ms"] = {{"median", done.median_update_milliseconds},
                                 {"max", done.max_update_milliseconds}};
            json["load"] = {{"median", done.load_quantile(0.5)},
                            {"99.9_percent", done.load_quantile(0.999)}};
            json["underflows"] = underflows;
        }
        return json;
    }

    void warn(const EngineStatistics& done) const {
        Warnings warnings;
        if (!common().quiet) {
            warnings = warnings_;
        }
        if (done.failed_updates > 0) {
            warnings.push_back(
                {file_,
                 std::to_string(done.failed_updates) +
                     " updates failed, and their sound stayed as it was: " + done.last_failure});
        }
        if (done.dropped_paths > 0) {
            warnings.push_back({file_,
                                std::to_string(done.dropped_paths) +
                                    " of the faintest or longest paths were left out of updates"});
        }
        print_warnings(warnings);
    }

    std::string file_, to_, output_, device_;
    std::vector<std::string> sounds_;
    bool list_devices_ = false;
    double seconds_ = 0.0, gain_db_ = 0.0, update_interval_ = 0.05;
    std::int64_t sample_rate_ = 48000, block_ = 256, rays_ = 2000;
    SceneChoice scene_choice_;
    WayOptions ways_;
    EmitterOptions emitters_;
    MaterialOptions materials_;
    SimulationChoice simulation_choice_;
    FormatChoice format_choice_;
    Warnings warnings_;                      // of the scene
    CLI::Option* seconds_option_ = nullptr;  // owned by the program
};

}  // namespace

std::unique_ptr<Command> make_play_command(CLI::App& program) {
    return std::make_unique<PlayCommand>(program);
}

}  // namespace earshot::cli
