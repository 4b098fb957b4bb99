// SPDX-License-Identifier: MIT
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <charconv>

namespace earshot::io {
namespace {

bool is_blank(char c) noexcept {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

template <typename Number>
std::optional<Number> parse(std::string_view word) noexcept {
    if (word.starts_with('+')) {
        word.remove_prefix(1);
    }
    Number number{};
    const char* end = word.data() + word.size();
    const auto [stop, code] = std::from_chars(word.data(), end, number);
    return code == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

}  // namespace

std::optional<std::string_view> Lines::next() {
    if (rest_.empty()) {
        return std::nullopt;
    }
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) {
        line.remove_suffix(1);
    }
    ++number_;
    return line;
}

std::string_view take_word(std::string_view& line) noexcept {
    const auto* begin = std::find_if_not(line.begin(), line.end(), is_blank);
    const auto* end = std::find_if(begin, line.end(), is_blank);
    const std::string_view word(begin, static_cast<std::size_t>(end - begin));
    line.remove_prefix(static_cast<std::size_t>(end - line.begin()));
    return word;
}

std::string_view trimmed(std::string_view text) noexcept {
    while (!text.empty() && is_blank(text.front())) {
        text.remove_prefix(1);
    }
    while (!text.empty() && is_blank(text.back())) {
        text.remove_suffix(1);
    }
    return text;
}

std::optional<double> to_number(std::string_view word) noexcept {
    return parse<double>(word);
}

std::optional<std::int64_t> to_integer(std::string_view word) noexcept {
    return parse<std::int64_t>(word);
}

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    while (true) {
        const std::size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) {
            return cells;
        }
        line.remove_prefix(comma + 1);
    }
}

}  // namespace earshot::io
