// SPDX-License-Identifier: MIT
#include "earshot/cli/command.h"

#include "earshot/io/whole_file.h"

namespace earshot::cli {

Command::Command(CLI::App& program,
                 const std::string& name,
                 const std::string& description,
                 const CommonOptionUse& use)
    : Command(program, name, description, WithoutOptions{}) {
    add_common_options(*app_, common_, use);
}

Command::Command(CLI::App& program,
                 const std::string& name,
                 const std::string& description,
                 WithoutOptions)
    : app_(program.add_subcommand(name, description)) {
    app_->group("Commands");
}

void Command::execute(const std::string& command_line) {
    command_line_ = command_line;
    for (const std::string* file : outputs_) {
        if (!file->empty()) {
            io::require_writable(*file);
        }
    }
    run();
}

CLI::Option* Command::add_output(const std::string& names,
                                 std::string& target,
                                 const std::string& description) {
    outputs_.push_back(&target);
    return app_->add_option(names, target, description);
}

CommandGroup::CommandGroup(CLI::App& program,
                           const std::string& name,
                           const std::string& description,
                           const std::string& footer,
                           const Makers& makers)
    : Command(program, name, description, WithoutOptions{}) {
    app().footer(footer);
    app().require_subcommand(1);
    for (const auto make : makers) {
        commands_.push_back(make(app()));
    }
}

void CommandGroup::run() {
    for (const std::unique_ptr<Command>& command : commands_) {
        if (command->is_chosen()) {
            command->execute(command_line());
            set_exit_status(command->exit_status());
        }
    }
}

}  // namespace earshot::cli
