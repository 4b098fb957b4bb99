// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

namespace earshot::cli {

/// The command line as a shell takes it, "earshot ir room.glb -o out", with folders left out of
/// every argument: what a page tells of how it was made is the same on every machine, and tells
/// nothing else. `arguments`: with the program's name first.
std::string command_line_without_folders(std::span<const char* const> arguments);

}  // namespace earshot::cli
