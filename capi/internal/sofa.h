// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"
#include "earshot/io/room_sofa.h"
#include "earshot/propagation/response.h"

#include <string>
#include <vector>

namespace earshot::capi {

// SOFA files, by the module. Each function throws Error naming `file` if there is no module.

/// The HRIR set of a SOFA file; null: the file of the default set. `raw`: as it was measured, not
/// without the delay that all responses have in common. Throws Error as io::read_hrir_set().
audio::HrirSet read_hrir_set(const char* file, bool raw);

/// The bytes of a SOFA file of responses. Throws Error as io::encode_room_responses().
std::string encode_room_responses(const std::string& file,
                                  const std::string& title,
                                  propagation::Channels kind,
                                  const std::vector<io::RoomMeasurement>& measurements);

}  // namespace earshot::capi
