// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"

namespace earshot::capi {

/// The HRIR set of a SOFA file; null: the file of the default set. `raw`: as it was measured, not
/// without the delay that all responses have in common. Throws Error as io::read_hrir_set().
audio::HrirSet read_hrir_set(const char* file, bool raw);

}  // namespace earshot::capi
