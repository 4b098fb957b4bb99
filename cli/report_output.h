// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/io/report.h"

#include <filesystem>
#include <string>
#include <vector>

namespace earshot::cli {

/// The option that says what a metric is to be, `--limit sti=0.6`.
class LimitOption {
public:
    /// Must outlive the parsing of the command line.
    CLI::Option* add_to(CLI::App& app);

    /// Throws UsageError if one is not of its form.
    std::vector<io::ReportLimit> limits(const CLI::App& app) const;

private:
    std::vector<std::string> texts_;
};

/// Whether a file of that name is to hold the data alone, not a page.
bool is_report_data(const std::filesystem::path& file);

/// Throws Error unless write_report() can make such a file of data: for work that takes long,
/// before it begins.
void require_report(const std::filesystem::path& file);

/// Writes the page of a report's data, or the data itself if the name ends in .json. Throws Error.
void write_report(const std::filesystem::path& file, const std::string& data);

/// The program's version, for ReportProvenance.
std::string program_version();

}  // namespace earshot::cli
