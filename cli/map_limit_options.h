// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/propagation/map_limit.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// The options that say what is mapped, and which limits it should keep.
class MapLimitOptions {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    /// Those of --metric in their order, then those that only limits name. Throws UsageError if one
    /// does not exist.
    std::vector<propagation::MapMetric> metrics(const CLI::App& app,
                                                const audio::Bands& bands) const;
    /// One per --limit. Throws UsageError if one is not of its form, or of a metric that has one.
    std::vector<propagation::MapLimit> limits(
        const CLI::App& app, const std::vector<propagation::MapMetric>& metrics) const;

    /// The share that --share asks for, 0 ... 1; 0 without it.
    double share() const noexcept { return share_percent_ / 100.0; }

private:
    std::string metrics_ = "sti,t30,c80";
    std::vector<std::string> limits_;
    double share_percent_ = 0.0;
};

}  // namespace earshot::cli
