// SPDX-License-Identifier: MIT
#include "earshot/io/internal/stated_unit.h"

#include "earshot/io/internal/text.h"

#include <array>
#include <utility>

namespace earshot::io {
namespace {

bool is_letter(char c) noexcept {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Removes and returns the next run of letters; empty at the end.
std::string_view take_letters(std::string_view& text) noexcept {
    while (!text.empty() && !is_letter(text.front())) {
        text.remove_prefix(1);
    }
    std::size_t size = 0;
    while (size < text.size() && is_letter(text[size])) {
        ++size;
    }
    const std::string_view word = text.substr(0, size);
    text.remove_prefix(size);
    return word;
}

std::string_view unit_named(std::string_view name) noexcept {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 21> kNames{{
        {"m", "m"},
        {"meter", "m"},
        {"meters", "m"},
        {"metre", "m"},
        {"metres", "m"},
        {"cm", "cm"},
        {"centimeter", "cm"},
        {"centimeters", "cm"},
        {"centimetre", "cm"},
        {"centimetres", "cm"},
        {"mm", "mm"},
        {"millimeter", "mm"},
        {"millimeters", "mm"},
        {"millimetre", "mm"},
        {"millimetres", "mm"},
        {"in", "in"},
        {"inch", "in"},
        {"inches", "in"},
        {"ft", "ft"},
        {"foot", "ft"},
        {"feet", "ft"},
    }};
    for (const auto& [known, unit] : kNames) {
        if (name == known) {
            return unit;
        }
    }
    return {};
}

/// Words that may stand between `units` and the name of one.
bool is_filler(std::string_view word) noexcept {
    constexpr std::array<std::string_view, 6> kFillers{"are", "is", "in", "of", "length", "file"};
    for (const std::string_view filler : kFillers) {
        if (word == filler) {
            return true;
        }
    }
    return false;
}

}  // namespace

std::optional<StatedUnit> unit_in_comment(std::string_view comment) {
    const std::string lower = lower_case(comment);
    std::string_view rest = lower;
    bool follows_word_unit = false;
    std::string_view last_filler;
    for (auto word = take_letters(rest); !word.empty(); word = take_letters(rest)) {
        if (word == "unit" || word == "units") {
            follows_word_unit = true;
            last_filler = {};
            continue;
        }
        if (!follows_word_unit) {
            continue;
        }
        // "units are in mm": a filler may also be the name of a unit, then the next word decides.
        if (is_filler(word)) {
            last_filler = word;
            continue;
        }
        const std::string_view unit = unit_named(word);
        if (!unit.empty()) {
            return StatedUnit{.unit = std::string(unit), .words = std::string(trimmed(comment))};
        }
        follows_word_unit = false;
    }
    if (follows_word_unit && last_filler == "in") {
        return StatedUnit{.unit = "in", .words = std::string(trimmed(comment))};
    }
    return std::nullopt;
}

}  // namespace earshot::io
