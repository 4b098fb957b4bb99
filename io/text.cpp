// SPDX-License-Identifier: MIT
#include "earshot/io/internal/text.h"

#include "earshot/base/error.h"

#include <algorithm>
#include <charconv>
#include <limits>

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

/// The encoding that a text cannot be read in; empty for ASCII and UTF-8.
std::string_view wide_encoding(std::string_view bytes) noexcept {
    constexpr std::string_view kUtf32LittleMark("\xFF\xFE\0\0", 4);
    constexpr std::string_view kUtf32BigMark("\0\0\xFE\xFF", 4);
    if (bytes.starts_with(kUtf32LittleMark) || bytes.starts_with(kUtf32BigMark)) {
        return "UTF-32";
    }
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
        return "UTF-16";
    }
    // Without a mark an ASCII character shows as a zero byte before or after it.
    const bool has_half_zero = bytes.size() >= 2 && (bytes[0] == '\0') != (bytes[1] == '\0');
    return has_half_zero ? "UTF-16" : "";
}

}  // namespace

std::string_view decoded_text(std::string_view bytes, const std::string& file) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (const std::string_view encoding = wide_encoding(bytes); !encoding.empty()) {
        throw Error(file, "is " + std::string(encoding) + " text", "save it as UTF-8");
    }
    if (bytes.starts_with(kByteOrderMark)) {
        bytes.remove_prefix(kByteOrderMark.size());
    }
    return bytes;
}

std::optional<std::string_view> Lines::next() {
    if (rest_.empty()) {
        return std::nullopt;
    }
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    const bool has_both = rest_.substr(end).starts_with("\r\n");
    rest_.remove_prefix(std::min(end + (has_both ? 2U : 1U), rest_.size()));
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

std::string lower_case(std::string_view text) {
    std::string lower(text);
    std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
        return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    });
    return lower;
}

std::string shortened(std::string_view text) {
    constexpr std::size_t kMaxLength = 40;
    return text.size() > kMaxLength ? std::string(text.substr(0, kMaxLength)) + " ..."
                                    : std::string(text);
}

std::optional<double> to_number(std::string_view word) noexcept {
    const std::string_view unsigned_word = word.substr(word.starts_with('-') ? 1 : 0);
    if (unsigned_word.starts_with("1.#")) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (const auto number = parse<double>(word)) {
        return number;
    }
    // A number too small for a double: std::from_chars refuses it like one that is too large.
    const std::size_t exponent = word.find_first_of("eE");
    const bool is_tiny =
        exponent != std::string_view::npos && word.substr(exponent + 1).starts_with('-') &&
        parse<double>(word.substr(0, exponent)) && parse<std::int64_t>(word.substr(exponent + 1));
    return is_tiny ? std::optional(0.0) : std::nullopt;
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

std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
        return std::string(text);
    }
    std::string field = "\"";
    for (const char c : text) {
        field += c == '"' ? "\"\"" : std::string(1, c);
    }
    return field + "\"";
}

}  // namespace earshot::io
