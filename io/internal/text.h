// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// The text of a file without its UTF-8 byte-order mark. Throws Error naming `file` if it is in
/// UTF-16 or UTF-32, told by its mark or by its zero bytes.
std::string_view decoded_text(std::string_view bytes, const std::string& file);

/// The lines of a text, one at a time. A line ends in a line feed, a carriage return or both.
class Lines {
public:
    explicit Lines(std::string_view text) : rest_(text) {}

    /// The next line without its end; nothing after the last.
    std::optional<std::string_view> next();

    std::size_t number() const noexcept { return number_; }  ///< of the last line given, from 1
    std::string name() const { return "line " + std::to_string(number_); }

    std::string_view rest() const noexcept { return rest_; }  ///< what follows the last line given

private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// Removes and returns the first word (no blanks or tabs); empty at the end.
std::string_view take_word(std::string_view& line) noexcept;

/// The cells between the commas of a line, trimmed; at least one.
std::vector<std::string_view> cells_of(std::string_view line);

/// A field of a CSV file (RFC 4180).
std::string csv_field(std::string_view text);

std::string_view trimmed(std::string_view text) noexcept;

/// ASCII letters in lower case; other bytes as they are.
std::string lower_case(std::string_view text);

/// The first characters of a word or line, for an error.
std::string shortened(std::string_view text);

/// The whole word as a number, the same in every locale; nothing if it is not one. The spellings of
/// older C libraries for what is no number (`1.#QNAN`, `-1.#IND`, `1.#INF`) give NaN.
std::optional<double> to_number(std::string_view word) noexcept;
std::optional<std::int64_t> to_integer(std::string_view word) noexcept;

}  // namespace earshot::io
