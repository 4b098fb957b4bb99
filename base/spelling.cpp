// SPDX-License-Identifier: MIT
#include "earshot/base/spelling.h"

#include <algorithm>
#include <utility>

namespace earshot {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Dynamic programming over prefixes (Wagner and Fischer 1974).
    const std::size_t width = b.size() + 1;
    std::vector<std::size_t> table((a.size() + 1) * width);
    const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& {
        return table[i * width + j];
    };
    for (std::size_t i = 0; i <= a.size(); ++i) {
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                at(i, j) = i + j;
                continue;
            }
            const std::size_t replaced = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
            at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
            }
        }
    }
    return at(a.size(), b.size());
}

std::string closest_word(std::string_view typed, std::span<const std::string> words) {
    std::string closest;
    std::size_t bound = std::max<std::size_t>(1, typed.size() / 3) + 1;
    for (const std::string& word : words) {
        const std::size_t distance = edit_distance(typed, word);
        if (distance < bound) {
            bound = distance;
            closest = word;
        }
    }
    return closest;
}

std::vector<std::string> closest_words(std::string_view typed,
                                       std::span<const std::string> words,
                                       std::size_t count) {
    std::vector<std::pair<std::size_t, std::string>> ranked;
    ranked.reserve(words.size());
    for (const std::string& word : words) {
        ranked.emplace_back(edit_distance(typed, word), word);
    }
    std::sort(ranked.begin(), ranked.end());
    ranked.resize(std::min(count, ranked.size()));
    std::vector<std::string> closest;
    closest.reserve(ranked.size());
    for (auto& [distance, word] : ranked) {
        closest.push_back(std::move(word));
    }
    return closest;
}

std::string did_you_mean(std::string_view typed,
                         std::span<const std::string> words,
                         const std::string& otherwise) {
    const std::string closest = closest_word(typed, words);
    return closest.empty() ? otherwise : "did you mean " + closest + "?";
}

}  // namespace earshot
