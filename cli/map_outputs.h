// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/propagation/map_limit.h"

#include <filesystem>
#include <string>
#include <vector>

namespace earshot::cli {

/// The files of a map, told by their suffixes.
class MapOutputs {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    /// Before long work. Throws UsageError for unknown suffixes, Error for files that cannot be
    /// written.
    void check(const CLI::App& app) const;

    bool is_empty() const noexcept { return files_.empty(); }

    /// The first file with another suffix, `.html`. Throws UsageError if there is none.
    std::filesystem::path page_file(const CLI::App& app) const;

    /// Writes them and returns their names. Pictures of several metrics or sources are one each,
    /// with __SOURCE__METRIC before the suffix.
    std::vector<std::string> write(const propagation::Scene& scene,
                                   const propagation::MetricMap& map,
                                   const std::vector<propagation::MapLimit>& limits) const;

private:
    std::vector<std::string> files_;
};

}  // namespace earshot::cli
