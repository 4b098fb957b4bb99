// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot {

/// Optimal string alignment distance: the number of insertions, deletions, replacements and swaps
/// of neighbours that make one word of the other (Levenshtein 1966, with the swaps of Damerau
/// 1964), where no letter is edited twice. O(length of a * length of b).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The word that was probably meant: the one with the smallest edit distance, if that is at most a
/// third of the typed length (at least 1); of equals the first. Empty if no word is that close.
std::string closest_word(std::string_view typed, std::span<const std::string> words);

/// At most `count` words in the order of their edit distance from `typed`; equals alphabetically.
std::vector<std::string> closest_words(std::string_view typed,
                                       std::span<const std::string> words,
                                       std::size_t count);

/// "did you mean WORD?" with the closest word, or `otherwise` if none is close.
std::string did_you_mean(std::string_view typed,
                         std::span<const std::string> words,
                         const std::string& otherwise);

}  // namespace earshot
