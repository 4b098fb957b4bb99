// SPDX-License-Identifier: MIT
#include "earshot/io/metrics.h"

#include "earshot/audio/measured_metrics.h"
#include "earshot/audio/response_metrics.h"
#include "earshot/audio/spatial_metrics.h"
#include "earshot/audio/stage_support.h"
#include "earshot/base/error.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/cli/sound_metrics_table.h"
#include "earshot/cli/speech_options.h"
#include "earshot/cli/strength_reference.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kFooter =
    "Prints EDT, T20, T30 (s), C50, C80 (dB), D50, Ts (s), G (dB) per band, their means of 500 Hz\n"
    "and 1 kHz, STI with its qualification letter, the bass ratio BR, and level (dB re full "
    "scale)\n"
    "and peak-to-noise ratio (dB) of the noise at the end, of every channel.\n"
    "A value that the response does not support is omitted, and the reason is given. Constant\n"
    "samples at the ends, an offset, and what precedes the direct sound are left out, which is\n"
    "told; so is clipping, and mains hum where it is the noise of a band.\n"
    "G needs a calibration: --reference gives the level (dB re full scale) that the source has in\n"
    "free field at 1 m with the gain of the recording, or a recording of it in free field.\n\n"
    "Examples:\n"
    "  earshot metrics measured.wav\n"
    "      steady noise at the end is estimated and taken out\n"
    "  earshot metrics seat*.wav -o seats.csv --reference free_field_10m.wav\n"
    "      a row per file, channel and band\n"
    "  earshot metrics sweep_response.wav --onset 0.412\n"
    "      where the direct sound is known to begin\n"
    "  earshot metrics out/source__listener.wav --noise-free --reference 0 --json\n"
    "      of a computed response, as earshot ir does\n"
    "  earshot metrics measured.wav --noise NC-30 --speech-level 58\n"
    "      STI of speech that reaches the listener with 58 dB(A), in noise";

audio::ImpulseResponse response_of(const io::Sound& sound, std::size_t channel) {
    const auto channels = static_cast<std::size_t>(sound.channels);
    audio::ImpulseResponse response{.sample_rate = sound.sample_rate, .samples = {}};
    for (std::size_t i = channel; i < sound.samples.size(); i += channels) {
        response.samples.push_back(sound.samples[i]);
    }
    return response;
}

void require_channels(const std::string& file, std::size_t required, std::size_t channels) {
    if (channels < required) {
        throw Error(file,
                    "has " + std::to_string(channels) + " channels, " + std::to_string(required) +
                        " needed",
                    "omit --listening");
    }
}

/// What the metrics of every file are computed with.
struct MetricsChoice {
    const audio::Bands& bands;
    std::size_t channel = 0;  // from 1; 0: all
    std::string listening{};
    bool noise_free = false;
    bool support = false;
    std::optional<double> onset{};  // seconds
    audio::MeasuredOptions measured{};
};

/// The part of a recording of several channels that is the response: from the first beginning to
/// the last end of any of them.
struct CommonPart {
    std::vector<audio::ImpulseResponse> channels{};
    std::optional<std::size_t> onset{};  // of the first channel, a sample of the part
};

class SoundReader {
public:
    SoundReader(const MetricsChoice& choice, const std::string& file)
        : choice_(choice), file_(file), sound_(io::read_sound(file)) {
        const auto channels = static_cast<std::size_t>(sound_.channels);
        if (choice.channel > channels) {
            throw Error(
                file, "has " + std::to_string(channels) + " channels", "choose one of them");
        }
        const auto frames = static_cast<double>(sound_.samples.size() / channels);
        if (choice.onset && *choice.onset * sound_.sample_rate >= frames) {
            throw Error(file,
                        "lasts " + std::to_string(frames / sound_.sample_rate) + " s",
                        "give an --onset within it");
        }
    }

    io::SoundMetrics metrics() {
        io::SoundMetrics metrics = {.file = std::filesystem::path(file_).filename().string(),
                                    .sample_rate = sound_.sample_rate,
                                    .speech = choice_.measured.speech};
        const auto channels = static_cast<std::size_t>(sound_.channels);
        for (std::size_t channel = 0; channel < channels; ++channel) {
            if (choice_.channel == 0 || choice_.channel == channel + 1) {
                metrics.channels.push_back(channel_metrics(channel));
            }
        }
        add_spatial(metrics);
        return metrics;
    }

    const Warnings& warnings() const { return warnings_; }

private:
    std::optional<std::size_t> known_onset() const {
        return choice_.onset ? std::optional(static_cast<std::size_t>(
                                   std::lround(*choice_.onset * sound_.sample_rate)))
                             : std::nullopt;
    }

    double time_of(std::size_t sample) const {
        return static_cast<double>(sample) / sound_.sample_rate;
    }

    io::ChannelMetrics channel_metrics(std::size_t channel) {
        const audio::ImpulseResponse response = response_of(sound_, channel);
        io::ChannelMetrics out = {.channel = channel + 1};
        if (choice_.noise_free) {
            const auto onset = known_onset() ? known_onset() : audio::direct_sound(response);
            out.metrics = audio::response_metrics(
                choice_.bands, response, {.onset = onset, .speech = choice_.measured.speech});
            audio::calibrate_strength(
                choice_.bands, choice_.measured.strength_correction_db, out.metrics);
            if (onset) {
                out.onset = time_of(*onset);
                add_support(response, *onset, out);
            }
        } else {
            audio::MeasuredOptions options = choice_.measured;
            options.onset = known_onset();
            const auto measured = audio::measured_metrics(choice_.bands, response, options);
            out.metrics = measured.metrics;
            if (const auto& part = measured.part) {
                out.onset = time_of(part->onset);
                add_support(part->response, part->onset - part->begin, out);
                warn_of_clipping(channel, part->clipping);
            }
        }
        out.bass_ratio = audio::bass_ratio(choice_.bands, out.metrics);
        return out;
    }

    void add_support(const audio::ImpulseResponse& response,
                     std::size_t onset,
                     io::ChannelMetrics& out) const {
        if (choice_.support) {
            out.support = audio::stage_support(choice_.bands, response, onset, !choice_.noise_free);
        }
    }

    void warn_of_clipping(std::size_t channel, const audio::Clipping& clipping) {
        const std::string where =
            sound_.channels > 1 ? "channel " + std::to_string(channel + 1) + ": " : "";
        if (clipping.samples > 0) {
            warnings_.push_back({file_,
                                 where + std::to_string(clipping.samples) +
                                     " samples are clipped; record with less gain"});
        } else if (clipping.one_at_full_scale) {
            warnings_.push_back(
                {file_,
                 where + "a sample stands at full scale: it is clipped, unless the file was "
                         "normalised"});
        }
    }

    /// The channels on one time axis.
    CommonPart common_part(std::size_t channels) const {
        CommonPart common;
        std::size_t begin = sound_.samples.size();
        std::size_t end = 0;
        for (std::size_t channel = 0; channel < channels; ++channel) {
            common.channels.push_back(response_of(sound_, channel));
            const auto part = choice_.noise_free
                                  ? std::nullopt
                                  : audio::measured_response(common.channels.back(), known_onset());
            begin = std::min(begin, part ? part->begin : 0);
            end = std::max(end,
                           part ? part->begin + part->response.samples.size()
                                : common.channels.back().samples.size());
            if (channel == 0) {
                common.onset = part ? part->onset : known_onset();
            }
        }
        for (audio::ImpulseResponse& channel : common.channels) {
            channel.samples = {channel.samples.begin() + static_cast<std::ptrdiff_t>(begin),
                               channel.samples.begin() + static_cast<std::ptrdiff_t>(end)};
        }
        if (common.onset) {
            *common.onset -= begin;
        }
        return common;
    }

    void add_spatial(io::SoundMetrics& metrics) const {
        const auto channels = static_cast<std::size_t>(sound_.channels);
        if (choice_.listening == "binaural") {
            require_channels(file_, 2, channels);
            const CommonPart ears = common_part(2);
            metrics.binaural =
                audio::binaural_metrics(choice_.bands, ears.channels[0], ears.channels[1]);
        } else if (choice_.listening == "ambisonic") {
            require_channels(file_, 4, channels);
            const CommonPart part = common_part(2);
            metrics.lateral = audio::lateral_metrics(
                choice_.bands, part.channels[0], part.channels[1], part.onset);
            const auto onset = part.onset ? part.onset : audio::direct_sound(part.channels[0]);
            metrics.late_lateral =
                audio::late_lateral_level(choice_.bands,
                                          part.channels[1],
                                          onset.value_or(0),
                                          !choice_.noise_free,
                                          choice_.measured.strength_correction_db);
        }
    }

    const MetricsChoice& choice_;
    const std::string& file_;
    io::Sound sound_;
    Warnings warnings_;
};

class MetricsCommand : public Command {
public:
    explicit MetricsCommand(CLI::App& program)
        : Command(program,
                  "metrics",
                  "Room acoustic metrics of impulse responses",
                  {.threads = false, .simd = false}) {
        app().add_option("FILE", files_, "WAV, FLAC, OGG or AIFF files")->required();
        output_option_ = add_output("-o,--output",
                                    output_,
                                    "write a table instead: .csv, a row per file, channel and "
                                    "band, or .json");
        add_integer(
            app(), "--channel", channel_, {0, 4096}, "number of the channel, from 1; 0: all");
        app()
            .add_option("--bands", bands_, "octave (31.5 Hz to 16 kHz) or third (20 Hz to 20 kHz)")
            ->check(CLI::IsMember({"octave", "third"}))
            ->capture_default_str();
        app()
            .add_option("--listening",
                        listening_,
                        "meaning of the channels: any, binaural (adds IACC) or ambisonic (adds "
                        "LF and LJ)")
            ->check(CLI::IsMember({"any", "binaural", "ambisonic"}))
            ->capture_default_str();
        onset_option_ = add_number(app(),
                                   "--onset",
                                   onset_,
                                   {0.0},
                                   "seconds into the file at which the direct sound begins; "
                                   "default: found, and told");
        reference_.add_to(app());
        app().add_flag("--support",
                       support_,
                       "add the stage support ST_early and ST_late: the microphone was 1 m from "
                       "the source");
        app().add_flag(
            "--noise-free", noise_free_, "the response is computed and has no noise floor");
        app().add_flag("--calibrated",
                       calibrated_,
                       "a sample of 1 is the pressure of the talker 1 m in front in free field, as "
                       "earshot ir writes: --reference 0, and --speech-level is meant there, not "
                       "at the listener");
        speech_.add_to(app(), "at the listener");
        app().footer(kFooter);
    }

    void run() override {
        const bool as_csv = output_suffix() == ".csv";
        const MetricsChoice choice = choice_of_options();
        std::vector<io::SoundMetrics> all;
        for (const std::string& file : files_) {
            SoundReader reader(choice, file);
            all.push_back(reader.metrics());
            if (!common().quiet) {
                print_warnings(reader.warnings());
            }
        }
        if (output_option_->count() > 0) {
            io::write_whole_file(output_,
                                 as_csv ? io::encode_metrics_table(choice.bands, all)
                                        : io::encode_sound_metrics(choice.bands, all));
        }
        if (common().json) {
            write_output(io::encode_sound_metrics(choice.bands, all));
        } else if (output_option_->count() > 0) {
            write_output(common().quiet ? ""
                                        : output_ + ": metrics of " + std::to_string(all.size()) +
                                              (all.size() == 1 ? " file\n" : " files\n"));
        } else {
            write_output(text_of(choice.bands, all));
        }
    }

private:
    static std::string text_of(const audio::Bands& bands,
                               const std::vector<io::SoundMetrics>& all) {
        std::string text;
        for (const io::SoundMetrics& sound : all) {
            text += (all.size() > 1 ? sound.file + "\n" : "") + sound_metrics_table(bands, sound);
        }
        return text;
    }

    /// Of the output, ".csv" or ".json"; empty if there is none.
    std::string output_suffix() const {
        if (output_option_->count() == 0) {
            return {};
        }
        const std::string suffix = std::filesystem::path(output_).extension().string();
        if (suffix != ".csv" && suffix != ".json") {
            throw Error(output_, "a table cannot be written as " + suffix, "use .csv or .json");
        }
        return suffix;
    }

    MetricsChoice choice_of_options() {
        MetricsChoice choice = {
            .bands = bands_ == "third" ? audio::Bands::third_octaves() : audio::Bands::octaves(),
            .channel = static_cast<std::size_t>(channel_),
            .listening = listening_,
            .noise_free = noise_free_,
            .support = support_};
        if (onset_option_->count() > 0) {
            choice.onset = onset_;
        }
        choice.measured.speech = speech_.conditions(app());
        if (choice.measured.speech) {
            choice.measured.speech->at_listener = !calibrated_;
        }
        choice.measured.strength_correction_db = strength_correction(choice.bands);
        return choice;
    }

    std::optional<audio::StrengthCorrection> strength_correction(const audio::Bands& bands) {
        if (calibrated_ && reference_.is_given()) {
            throw wrong_usage(app(), "--calibrated", "is --reference 0: give one of them");
        }
        const auto correction_db = reference_.correction_db(bands);
        return calibrated_ ? audio::StrengthCorrection(bands.count(), 0.0) : correction_db;
    }

    std::vector<std::string> files_;
    std::string output_;
    std::int64_t channel_ = 0;
    std::string bands_ = "octave";
    std::string listening_ = "any";
    double onset_ = 0.0;
    StrengthReference reference_;
    bool support_ = false;
    bool noise_free_ = false;
    bool calibrated_ = false;
    SpeechOptions speech_;
    CLI::Option* output_option_ = nullptr;  // owned by the program, as those below
    CLI::Option* onset_option_ = nullptr;
};

}  // namespace

std::unique_ptr<Command> make_metrics_command(CLI::App& program) {
    return std::make_unique<MetricsCommand>(program);
}

}  // namespace earshot::cli
