// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/auralization.h"

#include <string>

namespace earshot::cli {

/// Reads a recording or a response. Throws Error also if the file holds no samples.
audio::Signal read_signal(const std::string& file);

/// Throws Error naming the file if the recording that a source is to play has several channels.
void require_mono(const std::string& file, const audio::Signal& recording);

}  // namespace earshot::cli
