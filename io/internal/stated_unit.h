// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace earshot::io {

/// A unit of length that an exporter states in a comment. The mesh formats have no field for it, so
/// it is a hint only.
struct StatedUnit {
    std::string unit;   ///< m, cm, mm, in or ft
    std::string words;  ///< the comment that states it, trimmed
};

/// The unit in a comment such as `File units = inches` or `units: mm`: the first name of a unit
/// after the word `unit` or `units`. Nothing if there is none.
std::optional<StatedUnit> unit_in_comment(std::string_view comment);

}  // namespace earshot::io
