// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// Lines of a text, one at a time, with or without carriage returns.
class Lines {
public:
    explicit Lines(std::string_view text) : rest_(text) {}

    /// The next line without its end; nothing after the last.
    std::optional<std::string_view> next();

    std::size_t number() const noexcept { return number_; }  ///< of the last line given, from 1
    std::string name() const { return "line " + std::to_string(number_); }

private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// Removes and returns the first word (no blanks or tabs); empty at the end.
std::string_view take_word(std::string_view& line) noexcept;

/// The cells between the commas of a line, trimmed; at least one.
std::vector<std::string_view> cells_of(std::string_view line);

std::string_view trimmed(std::string_view text) noexcept;

/// The whole word as a number, the same in every locale; nothing if it is not one.
std::optional<double> to_number(std::string_view word) noexcept;
std::optional<std::int64_t> to_integer(std::string_view word) noexcept;

}  // namespace earshot::io
