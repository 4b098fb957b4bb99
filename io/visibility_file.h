// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/visible_sets.h"

#include <filesystem>

namespace earshot::io {

// Visible sets in a format of their own (docs/files.md): binary, little-endian, with a version at
// its beginning and a checksum at its end. What is written and read again is the same, and so are
// the bytes.

/// Writes the file whole or not at all. Throws Error naming the file.
void write_visible_sets(const std::filesystem::path& file, const visibility::VisibleSets& sets);

/// Throws Error naming the file, and where in it, if it is missing, damaged, cut off or of another
/// version.
visibility::VisibleSets read_visible_sets(const std::filesystem::path& file);

}  // namespace earshot::io
