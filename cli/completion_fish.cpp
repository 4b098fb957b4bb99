// SPDX-License-Identifier: MIT
#include "earshot/cli/completion.h"

#include <string_view>

namespace earshot::cli {
namespace {

std::string in_quotes(std::string_view text) {
    std::string result = "'";
    for (const char letter : text) {
        if (letter == '\'' || letter == '\\') {
            result += '\\';
        }
        result += letter;
    }
    return result + "'";
}

std::string names_below(const CommandEntry& command) {
    std::vector<std::string> names;
    for (const CommandEntry& below : command.commands) {
        names.push_back(below.words.back());
    }
    return joined(names, " ");
}

// When the command line has come as far as `command`, and not to one below it.
std::string condition(const CommandEntry& command) {
    std::vector<std::string> parts;
    for (std::size_t i = 1; i < command.words.size(); ++i) {
        parts.push_back("__fish_seen_subcommand_from " + command.words[i]);
    }
    if (!command.commands.empty()) {
        parts.push_back("not __fish_seen_subcommand_from " + names_below(command));
    }
    return in_quotes(joined(parts, "; and "));
}

std::string option_line(const std::string& begin, const OptionEntry& option) {
    std::string text = begin;
    for (const std::string& name : option.names) {
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    if (option.value == ValueKind::choice) {
        text += " -x -a " + in_quotes(joined(option.choices, " "));
    } else if (option.value == ValueKind::number) {
        text += " -x";
    } else if (option.value == ValueKind::text) {
        text += " -r -F";
    }
    return text + " -d " + in_quotes(option.description) + "\n";
}

}  // namespace

std::string fish_completion(const CommandEntry& program) {
    std::string text =
        "# Completion of earshot for fish; written by the program's build.\n"
        "complete -c earshot -f\n";
    for (const CommandEntry* command : all_commands(program)) {
        const std::string begin = "complete -c earshot -n " + condition(*command);
        for (const CommandEntry& below : command->commands) {
            text +=
                begin + " -a " + below.words.back() + " -d " + in_quotes(below.description) + "\n";
        }
        for (const OptionEntry& option : command->options) {
            text += option_line(begin, option);
        }
        if (command->words.back() == "help") {
            text += begin + " -a " + in_quotes(names_below(program)) + "\n";
        } else if (!command->arguments.empty()) {
            text += begin + " -F\n";
        }
    }
    return text;
}

}  // namespace earshot::cli
