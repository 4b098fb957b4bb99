// SPDX-License-Identifier: MIT
#include "earshot/cli/completion.h"

#include <string_view>

namespace earshot::cli {
namespace {

// A text between single quotes, within which _arguments reads brackets and colons.
std::string escaped(std::string_view text) {
    std::string result;
    for (const char letter : text) {
        if (letter == '\'') {
            result += "'\\''";
        } else {
            if (letter == '[' || letter == ']' || letter == ':' || letter == '\\') {
                result += '\\';
            }
            result += letter;
        }
    }
    return result;
}

std::string function_of(const CommandEntry& command) {
    return "_" + joined(command.words, "_");
}

// ":FILE:_files", what _arguments takes for a value.
std::string value_of(const OptionEntry& option) {
    switch (option.value) {
        case ValueKind::none:
            return "";
        case ValueKind::choice:
            return ":" + escaped(option.names.back()) + ":(" + joined(option.choices, " ") + ")";
        case ValueKind::number:
            return ":" + escaped(option.placeholder) + ": ";
        case ValueKind::text:
            break;
    }
    return ":" + escaped(option.placeholder) + ":_files";
}

// One argument of _arguments per spelling; those of one option exclude each other.
std::string option_specification(const OptionEntry& option) {
    std::string text;
    for (const std::string& name : option.names) {
        const std::string before =
            option.is_repeatable ? "*" : "(" + joined(option.names, " ") + ")";
        const bool takes_equals = option.value != ValueKind::none && name.starts_with("--");
        text += "        '" + before + name + (takes_equals ? "=" : "") + "[" +
                escaped(option.description) + "]" + value_of(option) + "' \\\n";
    }
    return text;
}

std::string arguments_specification(const CommandEntry& command, const CommandEntry& program) {
    std::string text;
    for (const OptionEntry& argument : command.arguments) {
        const std::string where = argument.is_repeatable || argument.names.front() == "RESPONSE"
                                      ? "*"
                                      : std::to_string(1 + (&argument - command.arguments.data()));
        std::string action = "_files";
        if (command.words.back() == "help") {
            action = "(";
            for (const CommandEntry& other : program.commands) {
                action += (action == "(" ? "" : " ") + other.words.back();
            }
            action += ")";
        }
        text +=
            "        '" + where + ":" + escaped(argument.names.front()) + ":" + action + "' \\\n";
    }
    return text;
}

// A command with commands below it hands over to their functions.
std::string group_function(const CommandEntry& command, const std::string& options) {
    std::string described, cases;
    for (const CommandEntry& below : command.commands) {
        described += "        '" + below.words.back() + ":" + escaped(below.description) + "'\n";
        cases += "            " + below.words.back() + ") " + function_of(below) + " ;;\n";
    }
    return function_of(command) + R"(() {
    local context state state_descr line curcontext="$curcontext"
    typeset -A opt_args
    local -a commands=(
)" + described +
           R"(    )
    _arguments -C \
)" + options +
           R"(        '1:COMMAND:->command' '*::ARGUMENT:->rest'
    case $state in
    command) _describe -t commands command commands ;;
    rest)
        case $words[1] in
)" + cases +
           R"(        esac
        ;;
    esac
}

)";
}

}  // namespace

std::string zsh_completion(const CommandEntry& program) {
    std::string text =
        "#compdef earshot\n"
        "# Completion of earshot for zsh; written by the program's build.\n\n";
    for (const CommandEntry* command : all_commands(program)) {
        std::string options;
        for (const OptionEntry& option : command->options) {
            options += option_specification(option);
        }
        text += command->commands.empty()
                    ? function_of(*command) + "() {\n    _arguments \\\n" + options +
                          arguments_specification(*command, program) + "        && return\n}\n\n"
                    : group_function(*command, options);
    }
    return text + R"(if [ "$funcstack[1]" = _earshot ]; then
    _earshot "$@"
else
    compdef _earshot earshot
fi
)";
}

}  // namespace earshot::cli
