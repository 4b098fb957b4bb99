// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/binaural.h"
#include "earshot/io/internal/sofa_file.h"

#include <string>

namespace earshot::io {

/// The head-related impulse responses of what has been read of a SOFA file, as read_hrir_set() says
/// there. Throws Error naming `file`.
audio::HrirSet hrir_set_of(const SofaFile& sofa, const std::string& file);

}  // namespace earshot::io
