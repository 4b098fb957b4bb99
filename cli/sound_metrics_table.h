// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/io/metrics.h"

#include <string>

namespace earshot::cli {

/// The metrics of a sound file for a person: per channel a line per value and a column per band.
std::string sound_metrics_table(const audio::Bands& bands, const io::SoundMetrics& sound);

}  // namespace earshot::cli
