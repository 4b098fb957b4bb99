// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/model_check.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace earshot::propagation {

enum class Severity : std::uint8_t {
    note,          ///< worth knowing, nothing to mend
    questionable,  ///< results may not be those of the room that is meant
    unusable       ///< no result can come of it
};

/// One sentence about a model, without a full stop.
struct Finding {
    Severity severity = Severity::note;
    std::string text;
};

/// What a report says, the gravest first: misplaced sources and listeners, unit and axis, leaks,
/// reversed and doubled faces, materials, then notes. `has_unit_option`: see unit_warning().
std::vector<Finding> model_findings(const Scene& scene,
                                    const ModelReport& report,
                                    bool has_unit_option = false);

/// That of the gravest; note if there is none.
Severity gravest(std::span<const Finding> findings);

}  // namespace earshot::propagation
