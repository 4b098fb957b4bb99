// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/propagation/locate.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace earshot::cli {

/// The part of `earshot calibrate` that locates sources and listeners: its options, work and
/// summary.
class LocateJob {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    bool is_chosen() const noexcept { return !file_.empty(); }

    struct Setting {
        const propagation::Scene& scene;
        propagation::Air air{};
        double time = 0.0;       ///< seconds, of the scene's animation
        int order = -1;          ///< -1: what the arrivals need
        std::uint64_t seed = 1;  ///< of the cross-validation
        std::string output;      ///< file to write
        bool quiet = false, json = false;
    };

    /// Reads the arrivals, locates, writes the file, and prints warnings and summary.
    void run(const Setting& setting, Executor& executor) const;

private:
    std::string file_;
    propagation::LocateOptions options_;
    std::int64_t folds_ = 0;
};

}  // namespace earshot::cli
