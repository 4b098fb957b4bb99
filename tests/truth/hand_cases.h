// SPDX-License-Identifier: MIT
#pragma once

#include "support/rooms.h"
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

namespace earshot::support {

/// A question whose answer can be worked out by hand.
struct HandCase {
    std::string name{};
    Room room{};
    std::vector<std::uint8_t> one_sided_labels{};
    geometry::Vec3 source{};
    geometry::Vec3 listener{};
    std::vector<std::size_t> paths_per_order{};  ///< up to the order to search
};

void PrintTo(const HandCase& one, std::ostream* stream);  // NOLINT: gtest's spelling

/// Obstacles, openings, sides: no decision within a tenth of a millimetre of turning.
std::vector<HandCase> clear_cases();

/// Paths that meet an edge or a corner exactly, legs that touch one, source and listener in one
/// place: right answers are those of the rules in frustum/trace.h, and doubles represent all
/// coordinates exactly.
std::vector<HandCase> degenerate_cases();

}  // namespace earshot::support
