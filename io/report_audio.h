// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"

#include <string>

namespace earshot::io {

/// What a page plays of a pair: sounds as data URIs.
struct ReportAudio {
    std::string dry{};  ///< as it was recorded
    std::string wet{};  ///< as the listener hears it
};

inline constexpr std::size_t kMaxReportSounds = 8;   ///< pairs with sound, the first
inline constexpr double kMaxReportSoundLength = 10;  ///< seconds of the recording, the first

/// The beginning of a recording, and what a listener hears of it; 16 bit at 16 kHz, each with the
/// same largest sample. Of more than two channels the first. Precondition: channels_fit().
ReportAudio make_report_audio(audio::Signal dry,
                              const audio::Signal& response,
                              Executor& executor = Executor::serial());

}  // namespace earshot::io
