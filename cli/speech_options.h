// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/speech.h"

#include <CLI/App.hpp>

#include <optional>
#include <string>

namespace earshot::cli {

/// --noise and --speech-level, for the speech transmission index.
class SpeechOptions {
public:
    /// `where`: at which place the level of speech is meant, "1 m in front of the talker".
    void add_to(CLI::App& app, const std::string& where);

    /// Nothing if neither was given. Throws the error of a wrong command line.
    std::optional<audio::SpeechConditions> conditions(const CLI::App& app) const;

private:
    std::optional<std::string> noise_, level_;
};

}  // namespace earshot::cli
