// SPDX-License-Identifier: MIT
#include "earshot/cli/auralize_paths.h"

#include "earshot/cli/recording.h"
#include "earshot/propagation/path_frames.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace earshot::cli {

void AuralizePaths::add_to(CLI::App& app) {
    CLI::Option* paths =
        app.add_option("--paths",
                       file_,
                       "in place of responses: paths.json of `earshot ir --frames`, over whose "
                       "paths DRY is played from the first instant on, without late sound")
            ->type_name("FILE");
    // The file tells what other options of scenes choose.
    constexpr std::array<const char*, 6> kShared = {
        "paths", "from", "to", "format", "hrtf", "hrtf-raw"};
    bool is_of_scene = false;
    for (CLI::Option* other : app.get_options()) {
        is_of_scene = is_of_scene || other->check_lname("scene");
        const bool is_shared = std::any_of(kShared.begin(), kShared.end(), [&](const char* name) {
            return other->check_lname(name);
        });
        if (is_of_scene && !is_shared) {
            paths->excludes(other);
        }
    }
}

void AuralizePaths::load(const CLI::App& app, const FormatChoice& choice) {
    choice.apply(app, format_);
    pairs_ = io::read_path_frames(file_);
}

propagation::MovingSound AuralizePaths::play(const std::string& source,
                                             const std::string& listener,
                                             const std::string& recording_name,
                                             const audio::Signal& recording,
                                             Executor& executor,
                                             Progress& progress) {
    require_mono(recording_name, recording);
    const propagation::PathFrames& frames = io::frames_of_pair(pairs_,
                                                               {.source = source,
                                                                .listener = listener,
                                                                .source_option = "--from",
                                                                .listener_option = "--to"});
    const std::vector<double>& samples = recording.channels.front();
    const auto rate = static_cast<double>(recording.sample_rate);
    const double seconds = frames.instants.back().time - frames.instants.front().time;
    const double played = static_cast<double>(samples.size()) / rate;
    // Frames that end with the recording do so but for rounding.
    if (frames.instants.size() > 1 && played > seconds + 1.0 / rate) {
        warnings_.push_back({recording_name,
                             "goes on after the last instant of " + file_ +
                                 ": source and listener stay there from then on"});
    }
    propagation::ResponseFormat format = format_;
    format.sample_rate = rate;
    return propagation::render_path_frames(frames, format, samples, executor, &progress);
}

}  // namespace earshot::cli
