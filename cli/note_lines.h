// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/metric_note.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// Notes for a person, "t20, t30 at 63, 125 Hz: TEXT": those of one text stand together.
std::vector<std::string> note_lines(const std::vector<audio::MetricNote>& notes);

}  // namespace earshot::cli
