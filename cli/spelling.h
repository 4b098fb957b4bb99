// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace earshot::cli {

/// The word somebody probably meant: the one with the fewest insertions, deletions, replacements
/// and swaps of neighbours from `typed`, if these are few enough for its length (a third, at least
/// one); of equals the first. Empty if no word is near.
std::string nearest_word(std::string_view typed, std::span<const std::string> words);

}  // namespace earshot::cli
