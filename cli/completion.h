// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/command_tree.h"

#include <string>

namespace earshot::cli {

// Scripts by which a shell completes commands, options and their values. Texts other than a choice
// of words complete to files.

std::string bash_completion(const CommandEntry& program);
std::string zsh_completion(const CommandEntry& program);
std::string fish_completion(const CommandEntry& program);

}  // namespace earshot::cli
