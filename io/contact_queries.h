// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/rational_ccd.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace earshot::io {

/// One elementary question of continuous collision detection.
struct ContactQuery {
    collision::RationalPoints points;
    std::optional<bool> truth;  ///< whether there is a contact, where the file says so
};

/// Reads queries of eight lines each, four points at the beginning of the step and four at its end:
/// numerator,denominator of x, y and z, and the truth (0 or 1, on every line of the query) if it is
/// known (Wang et al. 2021). Throws Error naming the file and line.
std::vector<ContactQuery> read_contact_queries(const std::filesystem::path& file);

}  // namespace earshot::io
