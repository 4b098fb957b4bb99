// SPDX-License-Identifier: MIT
#include "earshot/cli/speech_options.h"

#include "earshot/audio/speech_levels.h"
#include "earshot/cli/arguments.h"
#include "earshot/cli/values.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace earshot::cli {
namespace {

constexpr double kMaxLevelDb = 200.0;  // either way

std::optional<double> parse_level(std::string_view text) {
    return parse_number_within(text, -kMaxLevelDb, kMaxLevelDb);
}

/// `L,L,L,L,L,L,L`, of the octaves from 125 Hz to 8 kHz.
std::optional<audio::SpeechSpectrum> parse_levels(std::string_view text) {
    audio::SpeechSpectrum levels{};
    const bool are_levels = parse_numbers(text, ',', levels) &&
                            std::all_of(levels.begin(), levels.end(), [](double level) {
                                return std::abs(level) <= kMaxLevelDb;
                            });
    return are_levels ? std::optional(levels) : std::nullopt;
}

std::optional<audio::SpeechSpectrum> parse_noise(std::string_view text) {
    constexpr std::string_view kCriterion = "NC-";
    if (!text.starts_with(kCriterion)) {
        return parse_levels(text);
    }
    const auto number = parse_number(text.substr(kCriterion.size()));
    return number ? audio::noise_criterion_db(*number) : std::nullopt;
}

std::optional<double> parse_speech_level(std::string_view text) {
    if (text == "normal") {
        return audio::kNormalSpeechDb;
    }
    if (text == "raised") {
        return audio::kRaisedSpeechDb;
    }
    return text == "loud" ? std::optional(audio::kLoudSpeechDb) : parse_level(text);
}

}  // namespace

void SpeechOptions::add_to(CLI::App& app, const std::string& where) {
    app.add_option("--noise",
                   noise_,
                   "noise at the listener, for STI: NC-15 ... NC-70, or seven octave levels from "
                   "125 Hz to 8 kHz in decibels, L,L,L,L,L,L,L")
        ->type_name("NOISE");
    app.add_option("--speech-level",
                   level_,
                   "level of speech " + where +
                       ", for STI: normal, raised, loud (60, 66, 72 dB) or A-weighted decibels; "
                       "normal if only --noise is given")
        ->type_name("LEVEL");
}

std::optional<audio::SpeechConditions> SpeechOptions::conditions(const CLI::App& app) const {
    if (!noise_ && !level_) {
        return std::nullopt;
    }
    audio::SpeechConditions conditions;
    if (noise_) {
        conditions.noise_db = parse_noise(*noise_);
        if (!conditions.noise_db) {
            throw wrong_usage(
                app,
                "--noise",
                "'" + *noise_ + "' is neither NC-15 ... NC-70 nor seven levels L,L,L,L,L,L,L");
        }
    }
    if (level_) {
        const auto level = parse_speech_level(*level_);
        if (!level) {
            throw wrong_usage(app,
                              "--speech-level",
                              "'" + *level_ + "' is none of normal, raised, loud and decibels");
        }
        conditions.speech_level_db = *level;
    }
    return conditions;
}

}  // namespace earshot::cli
