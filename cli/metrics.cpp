// SPDX-License-Identifier: MIT
#include "earshot/io/metrics.h"

#include "earshot/audio/response_metrics.h"
#include "earshot/audio/spatial_metrics.h"
#include "earshot/base/error.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/note_lines.h"
#include "earshot/cli/output.h"
#include "earshot/cli/speech_options.h"
#include "earshot/io/wav.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

using audio::BandMetrics;
using audio::RoomMetrics;

constexpr const char* kFooter =
    "Prints EDT, T20, T30 (s), C50, C80 (dB), D50, Ts (s), G (dB) per band, their means of 500 Hz\n"
    "and 1 kHz, and STI with its qualification letter, of every channel.\n"
    "A value that the response does not support is omitted, and the reason is given.\n\n"
    "Examples:\n"
    "  earshot metrics measured.wav\n"
    "      steady noise at the end is estimated and taken out\n"
    "  earshot metrics out/source__listener.wav --noise-free --json\n"
    "      of a computed response, as earshot ir does\n"
    "  earshot metrics measured.wav --noise NC-30 --speech-level 58\n"
    "      STI of speech that reaches the listener with 58 dB(A), in noise";

struct Row {
    const char* name;
    std::optional<double> BandMetrics::*value;
    const char* format;
};

constexpr std::array<Row, 8> kRows = {{{"EDT s", &BandMetrics::early_decay_time, "%9.3f"},
                                       {"T20 s", &BandMetrics::reverberation_time_t20, "%9.3f"},
                                       {"T30 s", &BandMetrics::reverberation_time_t30, "%9.3f"},
                                       {"C50 dB", &BandMetrics::clarity_c50_db, "%9.2f"},
                                       {"C80 dB", &BandMetrics::clarity_c80_db, "%9.2f"},
                                       {"D50", &BandMetrics::definition_d50, "%9.3f"},
                                       {"Ts s", &BandMetrics::centre_time, "%9.4f"},
                                       {"G dB", &BandMetrics::strength_db, "%9.2f"}}};

std::string formatted(const char* format, double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

std::string head_of(const std::string& text) {
    return text + std::string(8 - std::min<std::size_t>(8, text.size()), ' ');
}

std::string row_of(const std::string& name, const std::vector<std::optional<double>>& values) {
    std::string text = head_of(name);
    for (const auto& value : values) {
        text += value ? formatted("%9.3f", *value) : std::string(8, ' ') + "-";
    }
    return text + "\n";
}

std::string lines_of(const std::vector<audio::MetricNote>& notes) {
    std::string text;
    for (const std::string& note : note_lines(notes)) {
        text += "  " + note + "\n";
    }
    return text;
}

std::string heads(const audio::Bands& bands) {
    std::string text = head_of("Hz");
    for (const double frequency_hz : bands.nominal_hz()) {
        text += formatted("%9g", frequency_hz);
    }
    return text + "\n";
}

/// A line per value, a column per band and one for the mean of 500 Hz and 1 kHz.
std::string table(const audio::Bands& bands, const RoomMetrics& metrics) {
    std::string text = heads(bands);
    text.insert(text.size() - 1, std::string(6, ' ') + "mid");
    for (const Row& row : kRows) {
        const auto cell = [&](const BandMetrics& band) {
            const auto& value = band.*row.value;
            return value ? formatted(row.format, *value) : std::string(8, ' ') + "-";
        };
        text += head_of(row.name);
        for (const BandMetrics& band : metrics.bands) {
            text += cell(band);
        }
        text += cell(metrics.mid) + "\n";
    }
    const auto& sti = metrics.speech_transmission_index;
    text += row_of("STI", {sti});
    if (sti) {
        text.insert(text.size() - 1, " " + std::string(audio::sti_letter(*sti)));
    }
    return text + lines_of(metrics.notes);
}

std::string binaural_table(const audio::Bands& bands, const audio::BinauralMetrics& metrics) {
    return heads(bands) + row_of("IACC_E", metrics.iacc_early) +
           row_of("IACC_L", metrics.iacc_late) + row_of("IACC_A", metrics.iacc) +
           lines_of(metrics.notes);
}

class MetricsCommand : public Command {
public:
    explicit MetricsCommand(CLI::App& program)
        : Command(program, "metrics", "Room acoustic metrics of an impulse response") {
        app().add_option("FILE", file_, "a WAV, FLAC or AIFF file")->required();
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
                        "LF)")
            ->check(CLI::IsMember({"any", "binaural", "ambisonic"}))
            ->capture_default_str();
        app().add_flag(
            "--noise-free", is_noise_free_, "the response is computed and has no noise floor");
        app().add_flag("--calibrated",
                       calibrated_,
                       "a sample of 1 is the pressure of the talker 1 m in front in free field, as "
                       "earshot ir writes: --speech-level is meant there, not at the listener");
        speech_.add_to(app(), "at the listener");
        app().footer(kFooter);
    }

    void run() override {
        const io::Sound sound = io::read_sound(file_);
        const auto channels = static_cast<std::size_t>(sound.channels);
        if (static_cast<std::size_t>(channel_) > channels) {
            throw Error(
                file_, "has " + std::to_string(channels) + " channels", "choose one of them");
        }
        const audio::Bands& bands =
            bands_ == "third" ? audio::Bands::third_octaves() : audio::Bands::octaves();
        io::SoundMetrics metrics = {.file = std::filesystem::path(file_).filename().string(),
                                    .sample_rate = sound.sample_rate,
                                    .speech = speech_.conditions(app())};
        if (metrics.speech) {
            metrics.speech->at_listener = !calibrated_;
        }
        std::string text;
        for (std::size_t channel = 0; channel < channels; ++channel) {
            if (channel_ != 0 && static_cast<std::size_t>(channel_) != channel + 1) {
                continue;
            }
            metrics.channel_numbers.push_back(channel + 1);
            metrics.channels.push_back(audio::response_metrics(
                bands,
                response_of(sound, channel),
                {.ends_in_noise = !is_noise_free_, .speech = metrics.speech}));
            text += (channels > 1 ? "channel " + std::to_string(channel + 1) + "\n" : "") +
                    table(bands, metrics.channels.back());
        }
        if (listening_ == "binaural") {
            require_channels(2, channels);
            metrics.binaural =
                audio::binaural_metrics(bands, response_of(sound, 0), response_of(sound, 1));
            text += binaural_table(bands, *metrics.binaural);
        } else if (listening_ == "ambisonic") {
            require_channels(4, channels);
            metrics.lateral =
                audio::lateral_metrics(bands, response_of(sound, 0), response_of(sound, 1));
            text += heads(bands) + row_of("LF", metrics.lateral->lateral_fraction) +
                    lines_of(metrics.lateral->notes);
        }
        write_output(common().json ? io::encode_sound_metrics(bands, metrics) : text);
    }

private:
    void require_channels(std::size_t least, std::size_t channels) const {
        if (channels < least) {
            throw Error(file_,
                        "has " + std::to_string(channels) + " channels, " + std::to_string(least) +
                            " needed",
                        "omit --listening");
        }
    }

    audio::ImpulseResponse response_of(const io::Sound& sound, std::size_t channel) const {
        const auto channels = static_cast<std::size_t>(sound.channels);
        audio::ImpulseResponse response{.sample_rate = sound.sample_rate, .samples = {}};
        for (std::size_t i = channel; i < sound.samples.size(); i += channels) {
            response.samples.push_back(sound.samples[i]);
            if (!std::isfinite(sound.samples[i])) {
                throw Error(file_, "holds samples that are not numbers", "export it again");
            }
        }
        return response;
    }

    std::string file_;
    std::int64_t channel_ = 0;
    std::string bands_ = "octave";
    std::string listening_ = "any";
    bool is_noise_free_ = false;
    bool calibrated_ = false;
    SpeechOptions speech_;
};

}  // namespace

std::unique_ptr<Command> make_metrics_command(CLI::App& program) {
    return std::make_unique<MetricsCommand>(program);
}

}  // namespace earshot::cli
