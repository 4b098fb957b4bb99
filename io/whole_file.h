// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace earshot::io {

/// Writes a file whole or not at all: beside its place first, then renamed over it. Throws Error
/// naming the file; a partial file never remains.
void write_whole_file(const std::filesystem::path& file, std::string_view bytes);

/// Takes the next bytes of a file.
using ByteSink = std::function<void(std::string_view)>;

/// The same with the bytes that `write` gives to a sink one after another, for files that would
/// not fit into memory beside what they are made of.
void write_whole_file(const std::filesystem::path& file,
                      const std::function<void(const ByteSink&)>& write);

/// Throws Error, as write_whole_file() would, unless the file can be written: for work that takes
/// long, before it begins. Leaves nothing behind.
void require_writable(const std::filesystem::path& file);

/// All bytes of a file. Throws Error naming the file if it is missing, a directory or unreadable.
std::string read_whole_file(const std::filesystem::path& file);

}  // namespace earshot::io
