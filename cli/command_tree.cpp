// SPDX-License-Identifier: MIT
#include "earshot/cli/command_tree.h"

#include "earshot/cli/arguments.h"

#include <algorithm>
#include <sstream>

namespace earshot::cli {
namespace {

// "a" and "b" of "TEXT:{a,b}", as CLI11 shows what CLI::IsMember takes.
std::vector<std::string> choices_of(const std::string& type_name) {
    const std::size_t begin = type_name.find(":{");
    if (begin == std::string::npos || !type_name.ends_with('}')) {
        return {};
    }
    std::istringstream list(type_name.substr(begin + 2, type_name.size() - begin - 3));
    std::vector<std::string> choices;
    for (std::string choice; std::getline(list, choice, ',');) {
        choices.push_back(choice);
    }
    return choices;
}

ValueKind kind_of(const OptionEntry& entry) {
    if (entry.placeholder.empty()) {
        return ValueKind::none;
    }
    if (!entry.choices.empty()) {
        return ValueKind::choice;
    }
    const bool is_number =
        entry.placeholder == "N" || entry.placeholder == "X" || entry.placeholder == "DB";
    return is_number ? ValueKind::number : ValueKind::text;
}

OptionEntry entry_of(const CLI::Option& option) {
    const bool is_flag = option.get_items_expected_max() == 0;
    const std::string type_name = is_flag ? "" : option.get_type_name();
    OptionEntry entry{.names = spellings(option),
                      .placeholder = type_name.substr(0, type_name.find(':')),
                      .choices = choices_of(type_name),
                      .default_value = option.get_default_str(),
                      .description = option.get_description(),
                      .group = option.get_group(),
                      .is_required = option.get_required(),
                      .is_repeatable = option.get_expected_max() > 1};
    if (option.get_positional()) {
        entry.names = {option.get_name(true)};
        entry.placeholder = entry.names.front();
    }
    if (entry.names.back() == "--simd") {
        entry.choices.clear();  // those of the processor at hand, which need not be the reader's
    }
    entry.value = kind_of(entry);
    return entry;
}

CommandEntry entry_of(const CLI::App& command, std::vector<std::string> words) {
    words.push_back(command.get_name());
    CommandEntry entry{
        .words = words, .description = command.get_description(), .footer = command.get_footer()};
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group() != kUnlisted) {
            (option->get_positional() ? entry.arguments : entry.options)
                .push_back(entry_of(*option));
        }
    }
    // As in the help, the common options come last.
    std::stable_partition(entry.options.begin(),
                          entry.options.end(),
                          [](const OptionEntry& option) { return option.group == "Options"; });
    for (const CLI::App* below : command.get_subcommands({})) {
        if (!below->get_group().empty()) {
            entry.commands.push_back(entry_of(*below, words));
        }
    }
    return entry;
}

void append(const CommandEntry& command, std::vector<const CommandEntry*>& all) {
    all.push_back(&command);
    for (const CommandEntry& below : command.commands) {
        append(below, all);
    }
}

}  // namespace

CommandEntry command_tree(const CLI::App& program) {
    return entry_of(program, {});
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
    std::string text;
    for (const std::string& word : words) {
        text += (text.empty() ? "" : separator) + word;
    }
    return text;
}

std::vector<const CommandEntry*> all_commands(const CommandEntry& command) {
    std::vector<const CommandEntry*> all;
    append(command, all);
    return all;
}

}  // namespace earshot::cli
