// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/measured_metrics.h"

#include <CLI/CLI.hpp>

#include <optional>
#include <string>

namespace earshot::cli {

/// --reference and --reference-distance, which calibrate G of recordings.
class StrengthReference {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    bool is_given() const noexcept { return !reference_.empty(); }

    /// What to add to G; nothing if there is no reference. Throws the error of a wrong command
    /// line, and Error as io::read_sound().
    std::optional<audio::StrengthCorrection> correction_db(const audio::Bands& bands) const;

private:
    const CLI::App* app_ = nullptr;
    std::string reference_;
    double distance_ = 10.0;
    CLI::Option* distance_option_ = nullptr;  // owned by the program
};

}  // namespace earshot::cli
