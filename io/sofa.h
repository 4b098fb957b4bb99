// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/binaural.h"

#include <filesystem>

namespace earshot::io {

/// Reads head-related impulse responses: SOFA (AES69), convention SimpleFreeFieldHRIR, two
/// receivers. Throws Error naming the file if it cannot be read, is of another kind, keeps delays
/// apart from the responses, or holds values that are not finite.
audio::HeadResponses read_head_responses(const std::filesystem::path& file);

}  // namespace earshot::io
