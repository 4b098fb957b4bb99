// SPDX-License-Identifier: MIT
#include "earshot/audio/convolve.h"
#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kFooter =
    "A mono recording gets the channels of the response; a recording of several channels needs a\n"
    "response of one channel or of the same number. Several responses, computed for the frames of\n"
    "a scene that moves, are applied to equal parts of the recording in turn and cross-faded.\n\n"
    "Examples:\n"
    "  earshot auralize speech.wav out/stage__seat.wav -o wet.wav\n"
    "  earshot auralize steps.wav out/stage__seat__*.wav -o wet.wav";

using Channels = std::vector<std::vector<double>>;

Channels channels_of(const io::Sound& sound) {
    const auto count = static_cast<std::size_t>(sound.channels);
    Channels channels(count);
    for (std::size_t i = 0; i < sound.samples.size(); ++i) {
        channels[i % count].push_back(sound.samples[i]);
    }
    return channels;
}

class AuralizeCommand : public Command {
public:
    explicit AuralizeCommand(CLI::App& program)
        : Command(program, "auralize", "Convolve a dry recording with impulse responses") {
        app().add_option("DRY", dry_file_, "an anechoic recording: WAV, FLAC or AIFF")->required();
        app()
            .add_option("RESPONSE", response_files_, "impulse responses, in order of time")
            ->required();
        add_output("-o,--output", output_, "the WAV file to write, 32-bit float")->required();
        peak_option_ = add_number(
            app(),
            "--peak",
            peak_db_,
            {-200.0, 0.0},
            "scale the largest sample to this level, decibels re full scale; default: no scaling");
        app().footer(kFooter);
    }

    void run() override {
        Executor executor(static_cast<int>(common().threads));
        const io::Sound dry = read(dry_file_);
        std::vector<Channels> responses;
        for (const std::string& file : response_files_) {
            responses.push_back(read_response(file, dry));
            if (responses.back().size() != responses.front().size()) {
                throw Error(file,
                            "differs in its number of channels from " + response_files_.front(),
                            "give responses of one receiver");
            }
        }
        const Channels wet = convolve(channels_of(dry), responses, executor);
        write(wet, dry.sample_rate);
    }

private:
    static io::Sound read(const std::string& file) {
        io::Sound sound = io::read_sound(file);
        if (sound.samples.empty()) {
            throw Error(file, "holds no samples");
        }
        if (!std::all_of(sound.samples.begin(), sound.samples.end(), [](double sample) {
                return std::isfinite(sample);
            })) {
            throw Error(file, "holds samples that are not numbers", "export it again");
        }
        return sound;
    }

    Channels read_response(const std::string& file, const io::Sound& dry) const {
        const io::Sound response = read(file);
        if (response.sample_rate != dry.sample_rate) {
            throw Error(file,
                        "is sampled at " + std::to_string(std::lround(response.sample_rate)) +
                            " Hz, " + dry_file_ + " at " +
                            std::to_string(std::lround(dry.sample_rate)) + " Hz",
                        "resample one of them, or compute the response with --sample-rate");
        }
        if (dry.channels != 1 && response.channels != 1 && response.channels != dry.channels) {
            throw Error(file,
                        "has " + std::to_string(response.channels) + " channels, " + dry_file_ +
                            " has " + std::to_string(dry.channels),
                        "one of them must have a single channel, or both the same number");
        }
        return channels_of(response);
    }

    static Channels convolve(const Channels& dry,
                             const std::vector<Channels>& responses,
                             Executor& executor) {
        Channels wet(std::max(dry.size(), responses.front().size()));
        for (std::size_t channel = 0; channel < wet.size(); ++channel) {
            Channels filters;
            for (const Channels& response : responses) {
                filters.push_back(response[response.size() == 1 ? 0 : channel]);
            }
            wet[channel] =
                audio::convolve_moving(dry[dry.size() == 1 ? 0 : channel], filters, executor);
        }
        return wet;
    }

    void write(const Channels& wet, double sample_rate) const {
        double largest = 0.0;
        for (const auto& channel : wet) {
            for (const double sample : channel) {
                largest = std::max(largest, std::abs(sample));
            }
        }
        const bool is_scaled = peak_option_->count() > 0 && largest > 0.0;
        const double scale = is_scaled ? math::pow10(peak_db_ / 20.0) / largest : 1.0;
        io::Sound sound{
            .sample_rate = sample_rate, .channels = static_cast<int>(wet.size()), .samples = {}};
        for (std::size_t n = 0; n < wet.front().size(); ++n) {
            for (const auto& channel : wet) {
                sound.samples.push_back(scale * channel[n]);
            }
        }
        io::write_whole_file(output_, io::encode_wav(sound));
        if (!common().quiet) {
            write_output(output_ + ": " + std::to_string(wet.size()) + " channels, " +
                         std::to_string(wet.front().size()) + " samples, largest " +
                         std::to_string(scale * largest) + "\n");
        }
    }

    std::string dry_file_, output_;
    std::vector<std::string> response_files_;
    double peak_db_ = 0.0;
    CLI::Option* peak_option_ = nullptr;  // owned by the program
};

}  // namespace

std::unique_ptr<Command> make_auralize_command(CLI::App& program) {
    return std::make_unique<AuralizeCommand>(program);
}

}  // namespace earshot::cli
