// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/command_tree.h"

#include <string>

namespace earshot::cli {

/// The manual page of a command in the man macros of roff. `program` is the whole tree, of which
/// the pages of related commands are named.
std::string manual_page(const CommandEntry& program,
                        const CommandEntry& command,
                        const std::string& version);

}  // namespace earshot::cli
