// SPDX-License-Identifier: MIT
#include "earshot/cli/completion.h"

namespace earshot::cli {
namespace {

// The words that may stand where a word begins with "-": every spelling of every option.
std::string option_words(const CommandEntry& command) {
    std::vector<std::string> words;
    for (const OptionEntry& option : command.options) {
        words.insert(words.end(), option.names.begin(), option.names.end());
    }
    return joined(words, " ");
}

std::string command_words(const CommandEntry& command) {
    std::vector<std::string> words;
    for (const CommandEntry& below : command.commands) {
        words.push_back(below.words.back());
    }
    return joined(words, " ");
}

// The patterns "earshot ir --order" | "earshot ir -n" of an option, one per spelling.
std::string patterns(const CommandEntry& command, const OptionEntry& option) {
    std::string text;
    for (const std::string& name : option.names) {
        text += (text.empty() ? "" : " | ");
        text += '"' + joined(command.words, " ") + " " + name + '"';
    }
    return text;
}

// What follows an option that takes a value.
std::string value_cases(const CommandEntry& program) {
    std::string text;
    for (const CommandEntry* command : all_commands(program)) {
        for (const OptionEntry& option : command->options) {
            if (option.value == ValueKind::none) {
                continue;
            }
            const std::string action =
                option.value == ValueKind::choice
                    ? "_earshot_words \"" + joined(option.choices, " ") + "\""
                    : (option.value == ValueKind::number ? "COMPREPLY=()" : "_earshot_files");
            text += "        " + patterns(*command, option) + ") " + action + "; return ;;\n";
        }
    }
    return text;
}

// What else may follow a command.
std::string word_cases(const CommandEntry& program) {
    std::string text;
    for (const CommandEntry* command : all_commands(program)) {
        std::string others = "_earshot_files";
        if (!command->commands.empty()) {
            others = "_earshot_words \"" + command_words(*command) + "\"";
        } else if (command->words.back() == "help") {
            others = "_earshot_words \"" + command_words(program) + "\"";
        }
        text += "        \"" + joined(command->words, " ") + "\") _earshot_either \"" +
                option_words(*command) + "\" || " + others + " ;;\n";
    }
    return text;
}

}  // namespace

std::string bash_completion(const CommandEntry& program) {
    std::string commands;
    for (const CommandEntry* command : all_commands(program)) {
        if (command->words.size() > 1) {
            commands += (commands.empty() ? "\"" : " | \"") + joined(command->words, " ") + "\"";
        }
    }
    return R"(# Completion of earshot for bash; written by the program's build.

_earshot_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$cur"); }

_earshot_files() {
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
}

# Options where a word begins like one.
_earshot_either() { [[ $cur == -* ]] && _earshot_words "$1"; }

_earshot() {
    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} command=earshot i
    # Bash splits --mode=sampled in three.
    if [[ $cur == = ]]; then
        cur=
    elif [[ $prev == = ]]; then
        prev=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    for ((i = 1; i < COMP_CWORD; i++)); do
        case "$command ${COMP_WORDS[i]}" in
        )" +
           commands +
           R"() command="$command ${COMP_WORDS[i]}" ;;
        esac
    done
    case "$command $prev" in
)" + value_cases(program) +
           R"(    esac
    case $command in
)" + word_cases(program) +
           R"(    esac
}

complete -F _earshot earshot
)";
}

}  // namespace earshot::cli
