// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/collide_motion.h"
#include "earshot/io/contacts.h"

#include <cstddef>
#include <string>

namespace earshot::cli {

/// What a search did, beside what it found.
struct CollideTotals {
    std::size_t steps = 0, contacts = 0;
    collision::WorldStatistics statistics;
    double seconds = 0.0;
};

/// What the summary tells beside totals.
struct CollideSummaryOptions {
    bool first = false;  ///< the first contact
    bool pairs = false;  ///< a line per pair of meshes that has contacts or was measured
};

/// For people.
std::string collide_summary(const CollideMotion& motion,
                            const io::ContactReport& report,
                            const CollideTotals& totals,
                            const CollideSummaryOptions& options,
                            const std::string& file);

/// The same for programs.
std::string collide_summary_json(const CollideMotion& motion,
                                 const io::ContactReport& report,
                                 const CollideTotals& totals,
                                 const CollideSummaryOptions& options,
                                 const std::string& file);

}  // namespace earshot::cli
