// SPDX-License-Identifier: MIT
#include "earshot/cli/arguments.h"

#include "earshot/base/simd.h"
#include "earshot/base/spelling.h"
#include "earshot/cli/values.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

namespace earshot::cli {
namespace {

std::string in_quotes(std::string_view text) {
    return "\"" + std::string(text) + "\"";
}

// Every spelling of the command's options, dashes included.
std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        const std::vector<std::string> spelt = spellings(*option);
        names.insert(names.end(), spelt.begin(), spelt.end());
    }
    return names;
}

// Those that the help lists.
std::vector<std::string> command_names(const CLI::App& program) {
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands({})) {
        if (!command->get_group().empty()) {
            names.push_back(command->get_name());
        }
    }
    return names;
}

// The command that was given, as far as it was: a group of commands if no one of them was.
const CLI::App& chosen_command(const CLI::App& program) {
    const std::vector<CLI::App*> chosen = program.get_subcommands();
    return chosen.empty() ? program : chosen_command(*chosen.front());
}

bool contains(std::span<const std::string> words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

// An option as it was typed without its value; empty if the argument is none (a value, "-0.5").
std::string typed_option(std::string_view argument) {
    if (argument.starts_with("--") && argument.size() > 2) {
        return std::string(argument.substr(0, argument.find('=')));
    }
    const bool is_short =
        argument.size() > 1 && argument[0] == '-' &&
        std::string_view("-.0123456789").find(argument[1]) == std::string_view::npos;
    return is_short ? std::string(argument.substr(0, 2)) : std::string();
}

// The remedy for a word that is not known: what was probably meant, and where to read on.
std::string suggestion(const CLI::App& command,
                       const std::string& typed,
                       std::span<const std::string> known) {
    constexpr std::size_t kShortOption = 2;  // "-x" is near every other short option
    const std::string closest = typed.size() > kShortOption ? closest_word(typed, known) : "";
    const std::string see = "see " + full_name(command) + " --help";
    return closest.empty() ? see : "did you mean " + closest + "? " + see;
}

UsageError unknown_option(const CLI::App& command, const std::string& option) {
    for (const CLI::App* subcommand : command.get_subcommands({})) {
        if (contains(option_names(*subcommand), option)) {
            return {option,
                    "is before the command",
                    "put it after: " + full_name(command) + " COMMAND " + option};
        }
    }
    return {option,
            full_name(command) + " has no such option",
            suggestion(command, option, option_names(command))};
}

// Throws for the first command or option that does not exist. Asked after parsing has failed,
// because a typing mistake explains more than what the parser says about the words around it.
void throw_if_misspelt(const CLI::App& program, std::span<const char* const> arguments) {
    const CLI::App* command = &program;
    for (const std::string_view argument : arguments) {
        if (argument == "--") {
            return;
        }
        const std::string option = typed_option(argument);
        if (!option.empty() && !contains(option_names(*command), option)) {
            throw unknown_option(*command, option);
        }
        if (option.empty() && !command_names(*command).empty()) {
            command = &find_command(*command, std::string(argument));
        }
    }
}

// What the parser found wrong, in this program's words.
UsageError reworded(const CLI::App& command, const CLI::ParseError& error) {
    const std::string message = error.what();
    const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
    const std::size_t colon = message.find(": ");
    if (colon != std::string::npos && code == CLI::ExitCodes::ExtrasError) {
        return wrong_usage(command, message.substr(colon + 2), "is one argument too many");
    }
    if (colon != std::string::npos && code == CLI::ExitCodes::ArgumentMismatch) {
        const bool is_missing = message.ends_with("missing");
        return wrong_usage(command,
                           message.substr(0, colon),
                           is_missing ? "needs a value" : "is given more than once");
    }
    return wrong_usage(command, full_name(command), message);
}

template <typename Number>
CLI::Option* add_checked(CLI::App& command,
                         const std::string& names,
                         const std::string& description,
                         const std::string& expected,
                         std::function<std::optional<Number>(const std::string&)> parse,
                         Limits<Number> limits,
                         std::function<void(Number)> keep) {
    const std::string shown_name = names.substr(names.rfind(',') + 1);
    return command.add_option_function<std::string>(
        names,
        [=, &command](const std::string& text) {
            const std::optional<Number> value = parse(text);
            if (!value || *value < limits.min || *value > limits.max) {
                throw wrong_usage(command, shown_name, in_quotes(text) + " is not " + expected);
            }
            keep(*value);
        },
        description);
}

// "a number", "a number of at least 0", "a number from 0 to 1".
template <typename Number>
std::string expected_value(const std::string& kind, Limits<Number> limits) {
    std::ostringstream text;
    text << kind;
    if (limits.max != Limits<Number>{}.max) {
        text << " from " << limits.min << " to " << limits.max;
    } else if (limits.min != Limits<Number>{}.min) {
        text << " of at least " << limits.min;
    }
    return text.str();
}

// Shows the value that `option` has when it is not given, unless its description does, or the value
// stands for none, being one that nobody can give.
template <typename Number>
CLI::Option* show_default(CLI::Option* option, Number value, Limits<Number> limits) {
    if (option->get_description().find("default") == std::string::npos && value >= limits.min &&
        value <= limits.max && std::isfinite(static_cast<double>(value))) {
        std::ostringstream text;
        text << value;
        option->default_str(text.str());
    }
    return option;
}

std::vector<std::string> simd_names() {
    std::vector<std::string> names = simd_targets();
    names.insert(names.begin(), "auto");
    return names;
}

}  // namespace

UsageError wrong_usage(const CLI::App& command, std::string subject, const std::string& what) {
    return {std::move(subject), what, "see " + full_name(command) + " --help"};
}

std::string HelpFormatter::make_help(const CLI::App* command,
                                     std::string name,
                                     CLI::AppFormatMode mode) const {
    std::string text = CLI::Formatter::make_help(command, std::move(name), mode);
    for (std::size_t at = text.find("\n\n\n"); at != std::string::npos;
         at = text.find("\n\n\n", at)) {
        text.erase(at, 1);
    }
    return text;
}

std::string HelpFormatter::make_group(std::string group,
                                      bool is_positional,
                                      std::vector<const CLI::Option*> options) const {
    if (group == kUnlisted) {
        return {};
    }
    return CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
}

std::string full_name(const CLI::App& command) {
    const CLI::App* const parent = command.get_parent();
    return parent == nullptr ? command.get_name() : full_name(*parent) + " " + command.get_name();
}

std::vector<std::string> spellings(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) {
        names.push_back("-" + name);
    }
    for (const std::string& name : option.get_lnames()) {
        names.push_back("--" + name);
    }
    return names;
}

const CLI::App& find_command(const CLI::App& program, const std::string& name) {
    for (const CLI::App* command : program.get_subcommands({})) {
        if (command->get_name() == name) {
            return *command;
        }
    }
    throw UsageError(name, "no such command", suggestion(program, name, command_names(program)));
}

void add_common_options(CLI::App& command, CommonOptions& options, const CommonOptionUse& use) {
    constexpr int kMaxThreads = 1024;
    const auto place = [](CLI::Option* option, bool is_shown) {
        option->group(is_shown ? "Common options" : kUnlisted);
    };
    place(add_integer(command,
                      "--threads",
                      options.threads,
                      {0, kMaxThreads},
                      "number of threads (default: 0, all cores); results do not depend on it"),
          use.threads);
    place(add_integer(command, "--seed", options.seed, {0}, "seed of random numbers (default: 1)"),
          use.seed);
    place(command
              .add_option("--simd",
                          options.simd,
                          "instruction set to use (default: auto); results do not depend on it")
              ->check(CLI::IsMember(simd_names())),
          use.simd);
    place(command.add_flag("--quiet", options.quiet, "print only errors"), true);
    place(command.add_flag("--json", options.json, "print a machine-readable summary"), true);
}

CLI::Option* add_integer(CLI::App& command,
                         const std::string& names,
                         std::int64_t& target,
                         Limits<std::int64_t> limits,
                         const std::string& description) {
    CLI::Option* option =
        add_checked<std::int64_t>(command,
                                  names,
                                  description,
                                  expected_value("a whole number", limits),
                                  parse_integer,
                                  limits,
                                  [&target](std::int64_t value) { target = value; })
            ->type_name("N");
    return show_default(option, target, limits);
}

CLI::Option* add_number(CLI::App& command,
                        const std::string& names,
                        double& target,
                        Limits<double> limits,
                        const std::string& description) {
    CLI::Option* option = add_checked<double>(command,
                                              names,
                                              description,
                                              expected_value("a number", limits),
                                              parse_number,
                                              limits,
                                              [&target](double value) { target = value; })
                              ->type_name("X");
    return show_default(option, target, limits);
}

CLI::Option* add_repeatable(CLI::App& command,
                            const std::string& names,
                            std::vector<std::string>& target,
                            const std::string& description) {
    return command.add_option(names, target, description)
        ->allow_extra_args(false)
        ->type_name("TEXT");
}

void parse_command_line(CLI::App& program, int argc, const char* const* argv) {
    try {
        program.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        throw;
    } catch (const CLI::CallForVersion&) {
        throw;
    } catch (const CLI::ParseError& error) {
        const std::span arguments(argv + 1, argv + argc);
        throw_if_misspelt(program, arguments);
        const CLI::App& command = chosen_command(program);
        if (!command.get_subcommands({}).empty()) {
            throw wrong_usage(command, "", "no command is given");
        }
        throw reworded(command, error);
    }
}

}  // namespace earshot::cli
