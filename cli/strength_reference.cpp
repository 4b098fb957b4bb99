// SPDX-License-Identifier: MIT
#include "earshot/cli/strength_reference.h"

#include "earshot/cli/arguments.h"
#include "earshot/cli/values.h"
#include "earshot/io/wav.h"

namespace earshot::cli {
namespace {

audio::ImpulseResponse first_channel(const io::Sound& sound) {
    audio::ImpulseResponse response{.sample_rate = sound.sample_rate, .samples = {}};
    for (std::size_t i = 0; i < sound.samples.size();
         i += static_cast<std::size_t>(sound.channels)) {
        response.samples.push_back(sound.samples[i]);
    }
    return response;
}

}  // namespace

void StrengthReference::add_to(CLI::App& app) {
    app_ = &app;
    app.add_option("--reference",
                   reference_,
                   "calibrates G: level of the source in free field at 1 m, decibels re full "
                   "scale (0 for files of earshot ir), or a recording of it in free field")
        ->type_name("DB|FILE");
    distance_option_ = add_number(app,
                                  "--reference-distance",
                                  distance_,
                                  {0.01, 1000.0},
                                  "metres from the source in that recording (default: 10)");
}

std::optional<audio::StrengthCorrection> StrengthReference::correction_db(
    const audio::Bands& bands) const {
    const auto level_db = parse_number(reference_);
    if (distance_option_->count() > 0 && (reference_.empty() || level_db)) {
        throw wrong_usage(*app_, "--reference-distance", "goes with a recording as --reference");
    }
    if (reference_.empty()) {
        return std::nullopt;
    }
    if (level_db) {
        return audio::StrengthCorrection(bands.count(), -*level_db);
    }
    return audio::strength_correction_db(
        bands, first_channel(io::read_sound(reference_)), distance_);
}

}  // namespace earshot::cli
