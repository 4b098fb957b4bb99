// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/binaural.h"

#include <filesystem>

namespace earshot::io {

/// Head responses of a KEMAR manikin (Gardner and Martin 1995), where Debian's libmysofa1 has them.
inline constexpr const char* kDefaultHrirSet = "/usr/share/libmysofa/MIT_KEMAR_normal_pinna.sofa";

/// Reads head-related impulse responses: SOFA (AES69), convention SimpleFreeFieldHRIR, two
/// receivers. Throws Error naming the file if it cannot be read, is of another kind, keeps delays
/// apart from the responses, or holds values that are not finite.
audio::HrirSet read_hrir_set(const std::filesystem::path& file);

}  // namespace earshot::io
