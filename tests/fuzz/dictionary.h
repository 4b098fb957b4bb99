// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace earshot::test {

/// The tokens of a dictionary in the form that libFuzzer reads: a line `name="value"` or `"value"`
/// each, `\\`, `\"` and `\xAB` escaped, comments after #. Throws std::runtime_error for another
/// line. Empty if there is no such file.
std::vector<std::string> read_dictionary(const std::filesystem::path& file);

}  // namespace earshot::test
