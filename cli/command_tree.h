// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace earshot::cli {

/// What a command line may hold at a place.
enum class ValueKind {
    none,    ///< a flag
    choice,  ///< one of OptionEntry::choices
    number,
    text  ///< a file, a point, a name
};

/// An option or a positional argument of a command, as its help shows it.
struct OptionEntry {
    std::vector<std::string> names{};  ///< "-o", "--output"; of a positional argument "SCENE"
    std::string placeholder{};         ///< "FILE"; empty: none
    std::vector<std::string> choices{};
    std::string default_value{};  ///< empty: not told
    std::string description{};
    std::string group{};  ///< heading that it stands under
    ValueKind value = ValueKind::none;
    bool is_required = false;
    bool is_repeatable = false;
};

/// A command with everything below it. Manual pages and completions are written from it.
struct CommandEntry {
    std::vector<std::string> words{};  ///< {"earshot", "pvs", "build"}
    std::string description{};
    std::string footer{};
    std::vector<OptionEntry> arguments{};
    std::vector<OptionEntry> options{};
    std::vector<CommandEntry> commands{};
};

/// The program with all commands and options that its help shows, in the help's order.
CommandEntry command_tree(const CLI::App& program);

/// The words with `separator` between them.
std::string joined(const std::vector<std::string>& words, const std::string& separator);

/// `command` and all below it, each before its own.
std::vector<const CommandEntry*> all_commands(const CommandEntry& command);

}  // namespace earshot::cli
