// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <string_view>

namespace earshot::io {

/// Writes all bytes to an open file or pipe, however often that is interrupted. False: it cannot,
/// and errno says why.
bool write_all(int descriptor, std::string_view bytes);

}  // namespace earshot::io
