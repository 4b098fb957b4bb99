// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/command.h"

#include <memory>

namespace earshot::cli {

// One per command, each in a file of its name (the manuals with the help); main.cpp holds the table
// of them.

std::unique_ptr<Command> make_auralize_command(CLI::App& program);
std::unique_ptr<Command> make_bvh_command(CLI::App& program);
std::unique_ptr<Command> make_calibrate_command(CLI::App& program);
std::unique_ptr<Command> make_ccd_command(CLI::App& program);
std::unique_ptr<Command> make_check_command(CLI::App& program);
std::unique_ptr<Command> make_simplify_command(CLI::App& program);
std::unique_ptr<Command> make_collide_command(CLI::App& program);
std::unique_ptr<Command> make_help_command(CLI::App& program);
std::unique_ptr<Command> make_ir_command(CLI::App& program);
std::unique_ptr<Command> make_los_command(CLI::App& program);
std::unique_ptr<Command> make_manuals_command(CLI::App& program);
std::unique_ptr<Command> make_map_command(CLI::App& program);
std::unique_ptr<Command> make_materials_command(CLI::App& program);
std::unique_ptr<Command> make_metrics_command(CLI::App& program);
std::unique_ptr<Command> make_play_command(CLI::App& program);
std::unique_ptr<Command> make_pvs_command(CLI::App& program);
std::unique_ptr<Command> make_report_command(CLI::App& program);
std::unique_ptr<Command> make_visible_command(CLI::App& program);

// Of earshot pvs.

std::unique_ptr<Command> make_pvs_build_command(CLI::App& group);
std::unique_ptr<Command> make_pvs_extract_command(CLI::App& group);
std::unique_ptr<Command> make_pvs_query_command(CLI::App& group);
std::unique_ptr<Command> make_pvs_show_command(CLI::App& group);

}  // namespace earshot::cli
