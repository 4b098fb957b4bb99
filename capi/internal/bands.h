// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <cstdint>

namespace earshot::capi {

/// The bands of an es_bands. Throws Failure for other numbers.
const audio::Bands& bands_of(std::int32_t bands, const char* argument);

}  // namespace earshot::capi
