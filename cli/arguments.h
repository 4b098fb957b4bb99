// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace earshot::cli {

/// The command line is wrong: exit status 2.
class UsageError : public Error {
public:
    using Error::Error;
};

/// A UsageError whose remedy is the help of `command` (a subcommand, or the program itself).
UsageError wrong_usage(const CLI::App& command, std::string subject, const std::string& what);

/// The common options that change what a command does; --quiet and --json do so for all.
struct CommonOptionUse {
    bool threads = true;
    bool seed = false;
    bool simd = true;
};

/// Options that every command takes.
struct CommonOptions {
    std::int64_t threads = 0;   ///< 0: one per core
    std::int64_t seed = 1;      ///< of everything random, >= 0
    std::string simd = "auto";  ///< instruction set of wide kernels
    bool quiet = false;         ///< print nothing but errors (and JSON, if asked for)
    bool json = false;          ///< print the summary as JSON
};

/// The group of options that are taken but not shown. (CLI11 would hide those of a group without a
/// name, and give them none in its errors.)
constexpr const char* kUnlisted = "Unlisted";

/// Help without unlisted options, and with no more than one empty line in a row.
class HelpFormatter : public CLI::Formatter {
public:
    std::string make_help(const CLI::App* command,
                          std::string name,
                          CLI::AppFormatMode mode) const override;
    std::string make_group(std::string group,
                           bool is_positional,
                           std::vector<const CLI::Option*> options) const override;
};

/// Adds them all, so that a script may pass them to any command. Help, manual pages and completions
/// show those that are in `use`.
void add_common_options(CLI::App& command, CommonOptions& options, const CommonOptionUse& use);

/// Every spelling of an option, dashes included: "-o", "--output".
std::vector<std::string> spellings(const CLI::Option& option);

/// "earshot ir" for a subcommand, "earshot" for the program.
std::string full_name(const CLI::App& command);

/// The subcommand of that name, one that is hidden included. Throws UsageError with a suggestion if
/// there is none.
const CLI::App& find_command(const CLI::App& program, const std::string& name);

// Options with values. `names` is as CLI11 takes it ("-o,--output"); `placeholder` stands for the
// value in the help. Values that are not of the form throw UsageError while the line is parsed.

/// The closed range of an option's value.
template <typename Number>
struct Limits {
    Number min = std::numeric_limits<Number>::lowest();
    Number max = std::numeric_limits<Number>::max();
};

CLI::Option* add_integer(CLI::App& command,
                         const std::string& names,
                         std::int64_t& target,
                         Limits<std::int64_t> limits,
                         const std::string& description);

CLI::Option* add_number(CLI::App& command,
                        const std::string& names,
                        double& target,
                        Limits<double> limits,
                        const std::string& description);

/// An option that may stand several times, each time with one value; kept in the order given.
CLI::Option* add_repeatable(CLI::App& command,
                            const std::string& names,
                            std::vector<std::string>& target,
                            const std::string& description);

/// Parses the command line. Throws UsageError with a suggestion if a command or an option is
/// misspelt; CLI::CallForHelp and CLI::CallForVersion pass through.
void parse_command_line(CLI::App& program, int argc, const char* const* argv);

}  // namespace earshot::cli
