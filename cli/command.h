// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"

#include <memory>
#include <string>
#include <vector>

namespace earshot::cli {

/// One subcommand: declares its options when it is made and does its work in run(). It must outlive
/// the parsing of the command line, which writes into its members.
class Command {
public:
    /// Adds the subcommand to `program`, common options included.
    Command(CLI::App& program,
            const std::string& name,
            const std::string& description,
            const CommonOptionUse& use = {});
    virtual ~Command() = default;
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

    /// The work. Throws Error if the input or the work fails, UsageError if the command line is
    /// wrong in a way that only the command can tell.
    virtual void run() = 0;

    /// run(), once it is known that the files of add_output() can be written. `command_line`: the
    /// whole, for pages that tell how they were made.
    void execute(const std::string& command_line);

    bool is_chosen() const { return app_->parsed(); }

    /// Of the program after run(): 0, or what set_exit_status() said.
    int exit_status() const { return exit_status_; }

protected:
    struct WithoutOptions {};
    Command(CLI::App& program,
            const std::string& name,
            const std::string& description,
            WithoutOptions);

    CLI::App& app() { return *app_; }

    /// An option that names a file to write. Whether it can be written is checked before run().
    CLI::Option* add_output(const std::string& names,
                            std::string& target,
                            const std::string& description);

    const CommonOptions& common() const { return common_; }
    const std::string& command_line() const { return command_line_; }

    /// For work that was done and whose answer is no, such as a limit that is not kept.
    void set_exit_status(int status) { exit_status_ = status; }

private:
    CLI::App* app_ = nullptr;  // owned by the program it was added to
    CommonOptions common_;
    std::string command_line_;
    int exit_status_ = 0;
    std::vector<const std::string*> outputs_;  // members of the command; empty: not given
};

/// Commands under one name: earshot GROUP COMMAND.
class CommandGroup : public Command {
public:
    using Makers = std::vector<std::unique_ptr<Command> (*)(CLI::App&)>;

    CommandGroup(CLI::App& program,
                 const std::string& name,
                 const std::string& description,
                 const std::string& footer,
                 const Makers& makers);

    /// Runs the one that was chosen.
    void run() override;

private:
    std::vector<std::unique_ptr<Command>> commands_;
};

}  // namespace earshot::cli
