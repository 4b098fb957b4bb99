// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/propagation/response.h"

#include <string>

namespace earshot::cli {

/// The options of what the channels of a sound are.
class FormatChoice {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    bool is_mono() const noexcept { return format_ == "mono"; }

    /// Sets channels, ambisonic order and HRIR set. Throws UsageError if --format is not of its
    /// form, Error for an HRIR set that cannot be read.
    void apply(const CLI::App& app, propagation::ResponseFormat& format) const;

private:
    std::string format_ = "mono", hrtf_file_;
    bool raw_hrtf_ = false;
};

}  // namespace earshot::cli
