// SPDX-License-Identifier: MIT
#include "earshot/cli/command.h"

namespace earshot::cli {

Command::Command(CLI::App& program, const std::string& name, const std::string& description)
    : app_(program.add_subcommand(name, description)) {
    app_->group("Commands");
    add_common_options(*app_, common_);
}

}  // namespace earshot::cli
