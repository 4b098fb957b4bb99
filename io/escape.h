// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <string>
#include <string_view>

namespace earshot::io {

/// The text with its control characters as escapes, so that names of files, scenes and materials
/// can do nothing to a terminal, a table or a page: C0, DEL, C1, line separators and marks of
/// writing direction become `\u001b` and the like, which JSON reads back, and bytes that are not
/// UTF-8 become `\x9b`. Line feeds stay if `keep_line_feeds`.
std::string escape_controls(std::string_view text, bool keep_line_feeds = false);

}  // namespace earshot::io
