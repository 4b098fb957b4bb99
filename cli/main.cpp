// SPDX-License-Identifier: MIT
#include "earshot/cli/command_line.h"
#include "earshot/cli/commands.h"
#include "earshot/cli/output.h"

#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

// The table of commands, in the order of the help.
constexpr std::unique_ptr<Command> (*kCommands[])(CLI::App&) = {
    make_check_command,
    make_simplify_command,
    make_ir_command,
    make_map_command,
    make_metrics_command,
    make_calibrate_command,
    make_auralize_command,
    make_play_command,
    make_report_command,
    make_bvh_command,
    make_los_command,
    make_visible_command,
    make_pvs_command,
    make_collide_command,
    make_ccd_command,
    make_materials_command,
    make_help_command,
    make_manuals_command,
};

/// The exit status.
int run(int argc, const char* const* argv) {
    CLI::App program(
        "Room acoustics from a 3D scene: sound paths, impulse responses, visibility, contacts");
    program.name("earshot");
    program.set_version_flag(
        "-V,--version", std::string("earshot ") + EARSHOT_VERSION, "Print the version and exit");
    program.formatter(std::make_shared<HelpFormatter>());
    constexpr std::size_t kHelpColumn = 26;
    program.get_formatter()->column_width(kHelpColumn);
    program.get_formatter()->label("SUBCOMMAND", "COMMAND");
    program.require_subcommand(1);
    program.footer(
        "earshot help COMMAND describes a command, as earshot COMMAND --help does.\n"
        "Exit status: 0 success, 1 an input or the computation failed, 2 a usage error,\n"
        "3 what was asked for is not so, where a command's help says it.");
    std::vector<std::unique_ptr<Command>> commands;
    for (const auto make_command : kCommands) {
        commands.push_back(make_command(program));
    }
    try {
        parse_command_line(program, argc, argv);
    } catch (const CLI::CallForHelp&) {
        write_output(program.help());
        return 0;
    } catch (const CLI::CallForVersion& version) {
        write_output(version.what() + std::string("\n"));
        return 0;
    }
    const std::string command_line =
        command_line_without_folders({argv, static_cast<std::size_t>(argc)});
    for (const std::unique_ptr<Command>& command : commands) {
        if (command->is_chosen()) {
            command->execute(command_line);
            return command->exit_status();
        }
    }
    return 0;
}

}  // namespace
}  // namespace earshot::cli

int main(int argc, char** argv) {
    constexpr int kFailed = 1;
    constexpr int kWrongUsage = 2;
    using earshot::cli::print_error;
    earshot::cli::prepare_standard_streams();
    try {
        return earshot::cli::run(argc, argv);
    } catch (const earshot::cli::UsageError& error) {
        print_error(error.line());
        return kWrongUsage;
    } catch (const earshot::Error& error) {
        print_error(error.line());
    } catch (const std::bad_alloc&) {
        print_error("out of memory; use a smaller scene, a lower order or a shorter response");
    } catch (const std::exception& error) {
        print_error(std::string("internal: ") + error.what() + "; please report this");
    }
    return kFailed;
}
