// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace earshot::io {

/// Where the data stands in the page that `report/bundle` makes.
inline constexpr std::string_view kReportDataMarker = "@EARSHOT_REPORT_DATA@";

/// The page without data; nothing if it was missing when the library was built.
std::optional<std::string_view> report_template() noexcept;

/// JSON text that a script element may hold: `<`, `>`, `&` and the line separators U+2028 and
/// U+2029, which JSON has in strings only, become `\u003c` and the like.
std::string escape_for_script(std::string_view json);

/// The page with data in the place of its marker, which stands in it once. Throws Error if it does
/// not.
std::string assemble_report(std::string_view page, std::string_view data);

}  // namespace earshot::io
