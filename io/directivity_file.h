// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/directivity.h"

#include <filesystem>
#include <string>

namespace earshot::io {

/// Reads a table of levels: a first line `azimuth,elevation,125,250,...` that names the frequencies
/// (hertz), then a line per direction of a full grid, in any order: degrees from the front to the
/// left, degrees above the front, and decibels re in front. Throws Error naming the file and line.
propagation::Directivity read_directivity(const std::filesystem::path& file);

/// The pattern of that name (Directivity::named) or, if the name ends in .csv, of that file, looked
/// for in `folder`. Throws Error naming `subject` for another name, else as read_directivity().
propagation::Directivity directivity_named(const std::string& name,
                                           const std::filesystem::path& folder,
                                           const std::string& subject);

}  // namespace earshot::io
