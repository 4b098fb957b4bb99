// SPDX-License-Identifier: MIT
#include "earshot/audio/auralization.h"
#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/base/simd.h"
#include "earshot/cli/auralize_paths.h"
#include "earshot/cli/auralize_scene.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"
#include "earshot/cli/progress_bar.h"
#include "earshot/cli/recording.h"
#include "earshot/cli/values.h"
#include "earshot/io/sound_file.h"
#include "earshot/io/sound_signal.h"
#include "earshot/io/wav.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace earshot::cli {
namespace {

constexpr const char* kFooter =
    "A mono recording gets the channels of the response; a recording of several channels needs a\n"
    "response of one channel or of the same number. Several responses, computed for the frames of\n"
    "a scene that moves, are applied to equal parts of the recording in turn and cross-faded: the\n"
    "room changes, but the pitch does not follow motion as it does with --scene and --paths.\n"
    "Each --mix adds a source with responses of its own; all of them begin together.\n"
    "A recording is resampled to the rate of its responses, and the result to that of the first\n"
    "source's responses or to --sample-rate. Levels are kept, unless --gain or --peak changes "
    "them.\n\n"
    "With --scene a source plays a mono recording while sources, the listener and surfaces move,\n"
    "by the scene's animation or by --path-of. Every path is a delay that follows its length, so\n"
    "that motion is heard as it is: a source that comes nearer at 10 m/s sounds 3 % higher.\n"
    "With --paths the same is made of paths that `earshot ir --frames` has found already, without\n"
    "the scene and without late sound, which paths.json does not hold. --from and --to name the\n"
    "pair; DRY begins at the first instant. --format binaural is heard with two ears.\n\n"
    "Examples:\n"
    "  earshot auralize speech.wav out/stage__seat.wav -o wet.wav\n"
    "  earshot auralize horn.wav --scene street.glb --path-of car=way.csv -o passing.wav\n"
    "  earshot auralize horn.wav --paths out/paths.json --from car --to seat -o passing.wav\n"
    "  earshot auralize steps.wav out/stage__seat__*.wav -o wet.flac --peak -1\n"
    "  earshot auralize violin.flac out/violin__seat.wav --mix cello.flac out/cello__seat.wav \\\n"
    "      --gain -6 --gain 0 --sample-rate 44100 -o duo.ogg";

using audio::Signal;

/// A recording and the responses of its receiver, in order of time.
struct SourceFiles {
    std::string dry;
    std::vector<std::string> responses;
};

std::string hertz(std::int64_t sample_rate) {
    return std::to_string(sample_rate) + " Hz";
}

void require_fit(const std::string& file,
                 const Signal& response,
                 const SourceFiles& source,
                 const Signal& dry) {
    if (!audio::channels_fit(dry, response)) {
        throw Error(file,
                    "has " + std::to_string(response.channels.size()) + " channels, " + source.dry +
                        " has " + std::to_string(dry.channels.size()),
                    "one of them must have a single channel, or both the same number");
    }
}

std::vector<Signal> read_responses(const SourceFiles& source, const Signal& dry) {
    std::vector<Signal> responses;
    for (const std::string& file : source.responses) {
        responses.push_back(read_signal(file));
        const Signal& response = responses.back();
        require_fit(file, response, source, dry);
        if (response.channels.size() != responses.front().channels.size()) {
            throw Error(file,
                        "differs in its number of channels from " + source.responses.front(),
                        "give responses of one receiver");
        }
        if (response.sample_rate != responses.front().sample_rate) {
            throw Error(file,
                        "is sampled at " + hertz(response.sample_rate) + ", " +
                            source.responses.front() + " at " +
                            hertz(responses.front().sample_rate),
                        "give responses of one receiver");
        }
    }
    return responses;
}

/// What the receiver hears of the source, at the sample rate of its responses.
Signal auralized(const SourceFiles& source, Executor& executor) {
    Signal dry = read_signal(source.dry);
    const std::vector<Signal> responses = read_responses(source, dry);
    return audio::auralize(std::move(dry), responses, executor);
}

double largest_of(const Signal& signal) {
    double largest = 0.0;
    for (const auto& channel : signal.channels) {
        for (const double sample : channel) {
            largest = std::max(largest, std::abs(sample));
        }
    }
    return largest;
}

class AuralizeCommand : public Command {
public:
    explicit AuralizeCommand(CLI::App& program)
        : Command(
              program,
              "auralize",
              "Convolve dry recordings with impulse responses, or play them in a scene that moves",
              {.seed = true}) {
        app()
            .add_option("DRY", source_.dry, "an anechoic recording: WAV, FLAC, OGG or AIFF")
            ->required();
        app().add_option("RESPONSE",
                         source_.responses,
                         "impulse responses, in order of time; none with --scene or --paths");
        app()
            .add_option("--mix",
                        mix_,
                        "another recording and its responses, or with --scene or --paths its "
                        "source, added to the first (repeatable)")
            ->expected(2, CLI::detail::expected_max_vector_size)
            ->type_name("DRY RESPONSE ...");
        add_output("-o,--output",
                   output_,
                   "the file to write: .wav (32-bit float), .flac (24 bit) or .ogg (Vorbis)")
            ->required();
        sample_rate_option_ = add_integer(app(),
                                          "--sample-rate",
                                          sample_rate_,
                                          {1000, 655350},
                                          "of the result, hertz; default: that of RESPONSE, with "
                                          "--scene or --paths that of DRY");
        add_repeatable(app(),
                       "--gain",
                       gains_,
                       "decibels: given once for all sources, or once for each in their order")
            ->type_name("DB");
        peak_option_ = add_number(
            app(),
            "--peak",
            peak_db_,
            {-200.0, 0.0},
            "scale the largest sample to this level, decibels re full scale; default: no scaling");
        scene_.add_to(app());
        paths_.add_to(app());
        app().footer(kFooter);
    }

    void run() override {
        const io::SoundFormat format = io::sound_format_of(output_);
        const std::vector<SourceFiles> sources = sources_of();
        const std::vector<double> scales = scales_of(sources.size());
        override_simd_target(common().simd);
        if (scene_.is_chosen()) {
            scene_.load(app(), common().seed);
        }
        if (paths_.is_chosen()) {
            paths_.load(app(), scene_.format_choice());
        }
        Executor executor(static_cast<int>(common().threads));
        Signal sum;
        for (std::size_t i = 0; i < sources.size(); ++i) {
            Signal wet = plays() ? played(sources[i], executor) : auralized(sources[i], executor);
            if (i == 0) {
                sum.sample_rate = sample_rate_option_->count() > 0 ? sample_rate_ : wet.sample_rate;
                sum.channels.resize(wet.channels.size());
            }
            if (wet.channels.size() != sum.channels.size()) {
                throw Error(sources[i].responses.front(),
                            "makes " + std::to_string(wet.channels.size()) + " channels of " +
                                sources[i].dry + ", the first source has " +
                                std::to_string(sum.channels.size()),
                            "give responses of one receiver");
            }
            audio::resample_to(sum.sample_rate, wet, executor);
            audio::add_scaled(wet, scales[i], sum);
        }
        if (!common().quiet) {
            print_warnings(scene_.warnings());
            print_warnings(paths_.warnings());
            warn_of_cross_fades(sources);
        }
        write(std::move(sum), format);
    }

private:
    /// Whether sources that are named play, in place of responses.
    bool plays() const noexcept { return scene_.is_chosen() || paths_.is_chosen(); }

    /// Recordings with their responses, or the names of the sources that play them.
    std::vector<SourceFiles> sources_of() {
        const bool needs_responses = !plays();
        if (needs_responses && source_.responses.empty()) {
            throw wrong_usage(app(), "RESPONSE", "is missing, and there is no --scene or --paths");
        }
        if (!needs_responses && !source_.responses.empty()) {
            throw wrong_usage(app(),
                              source_.responses.front(),
                              "is a response, which " +
                                  std::string(paths_.is_chosen() ? "--paths" : "--scene") +
                                  " takes the place of");
        }
        std::vector<SourceFiles> sources = {source_};
        for (const auto& files : mix_) {
            if (files.size() < 2) {
                throw wrong_usage(app(),
                                  "--mix",
                                  needs_responses ? "needs a recording and a response"
                                                  : "needs a recording and the name of a source");
            }
            if (!needs_responses && files.size() > 2) {
                throw wrong_usage(app(), "--mix", "takes one source for a recording");
            }
            sources.push_back({files.front(), {files.begin() + 1, files.end()}});
        }
        return sources;
    }

    /// Between two responses of a source that moves phases are faded, not shifted.
    void warn_of_cross_fades(const std::vector<SourceFiles>& sources) const {
        const auto moving = std::find_if(sources.begin(), sources.end(), [](const auto& source) {
            return source.responses.size() > 1;
        });
        if (moving != sources.end()) {
            print_warnings({{moving->responses.front(),
                             std::to_string(moving->responses.size()) +
                                 " responses are cross-faded, so that the pitch does not follow "
                                 "motion; --scene with --path-of or an animation renders it, and "
                                 "so does --paths"}});
        }
    }

    Signal played(const SourceFiles& source, Executor& executor) {
        ProgressBar progress(common().quiet);
        const std::string name = source.responses.empty() ? "" : source.responses.front();
        const Signal dry = read_signal(source.dry);
        propagation::MovingSound sound =
            paths_.is_chosen() ? paths_.play(name.empty() ? scene_.from() : name,
                                             scene_.to(),
                                             source.dry,
                                             dry,
                                             executor,
                                             progress)
                               : scene_.play(name, source.dry, dry, executor, progress);
        played_ += "; " + std::to_string(sound.paths) + " paths at " +
                   std::to_string(sound.instants) + " instants";
        return std::move(sound.signal);
    }

    std::vector<double> scales_of(std::size_t sources) {
        if (gains_.size() > 1 && gains_.size() != sources) {
            throw wrong_usage(app(),
                              "--gain",
                              "is given " + std::to_string(gains_.size()) + " times for " +
                                  std::to_string(sources) + " sources");
        }
        std::vector<double> scales(sources, 1.0);
        for (std::size_t i = 0; i < sources && !gains_.empty(); ++i) {
            const std::string& text = gains_[gains_.size() == 1 ? 0 : i];
            const std::optional<double> gain_db =
                parse_number_within(text, -kMaxGainDb, kMaxGainDb);
            if (!gain_db) {
                throw wrong_usage(
                    app(), "--gain", "\"" + text + "\" is not a number from -200 to 200");
            }
            scales[i] = math::pow10(*gain_db / 20.0);
        }
        return scales;
    }

    void write(Signal wet, io::SoundFormat format) const {
        if (const double largest = largest_of(wet); peak_option_->count() > 0 && largest > 0.0) {
            const double scale = math::pow10(peak_db_ / 20.0) / largest;
            for (auto& channel : wet.channels) {
                for (double& sample : channel) {
                    sample *= scale;
                }
            }
        }
        const double largest = largest_of(wet);
        const io::Sound sound = io::sound_of(wet);
        io::write_whole_file(output_, io::encode_sound(sound, format));
        const std::size_t clipped = io::count_beyond_full_scale(sound);
        if (clipped > 0 && format != io::SoundFormat::wav) {
            print_warnings({{output_,
                             std::to_string(clipped) +
                                 " samples exceed full scale and are clipped, the largest is " +
                                 std::to_string(largest) + "; use --peak or --gain"}});
        }
        if (!common().quiet) {
            write_output(output_ + ": " + std::to_string(wet.channels.size()) + " channels, " +
                         std::to_string(wet.channels.front().size()) + " samples at " +
                         hertz(wet.sample_rate) + ", largest " + std::to_string(largest) + played_ +
                         "\n");
        }
    }

    static constexpr double kMaxGainDb = 200.0;

    SourceFiles source_;
    std::vector<std::vector<std::string>> mix_;
    std::string output_;
    std::vector<std::string> gains_;
    std::int64_t sample_rate_ = 0;
    double peak_db_ = 0.0;
    AuralizeScene scene_;
    AuralizePaths paths_;
    std::string played_;                         // what is told of it
    CLI::Option* sample_rate_option_ = nullptr;  // owned by the program
    CLI::Option* peak_option_ = nullptr;         // owned by the program
};

}  // namespace

std::unique_ptr<Command> make_auralize_command(CLI::App& program) {
    return std::make_unique<AuralizeCommand>(program);
}

}  // namespace earshot::cli
