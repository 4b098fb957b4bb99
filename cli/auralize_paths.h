// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"
#include "earshot/base/error.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/cli/arguments.h"
#include "earshot/cli/format_choice.h"
#include "earshot/io/path_frames.h"
#include "earshot/propagation/moving_sound.h"
#include "earshot/propagation/response.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// The option of `earshot auralize --paths`, and paths over time in which recordings are played.
class AuralizePaths {
public:
    /// Must outlive the parsing of the command line. `app` has the options of AuralizeScene, of
    /// which those of names and FormatChoice may be given beside it.
    void add_to(CLI::App& app);

    bool is_chosen() const noexcept { return !file_.empty(); }

    /// Reads the paths. Call before play(). `choice` has been added to `app`. Throws Error, and
    /// UsageError as FormatChoice::apply().
    void load(const CLI::App& app, const FormatChoice& choice);

    /// What the listener hears of a mono recording played by the source; an empty name is that of
    /// the only one. Throws Error if the file has no such pair.
    propagation::MovingSound play(const std::string& source,
                                  const std::string& listener,
                                  const std::string& recording_name,
                                  const audio::Signal& recording,
                                  Executor& executor,
                                  Progress& progress);

    /// What is odd about what was played.
    const Warnings& warnings() const noexcept { return warnings_; }

private:
    std::string file_;
    std::vector<io::PairPathFrames> pairs_;
    propagation::ResponseFormat format_;
    Warnings warnings_;
};

}  // namespace earshot::cli
