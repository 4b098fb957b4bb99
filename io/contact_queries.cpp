// SPDX-License-Identifier: MIT
#include "earshot/io/contact_queries.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/text.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace earshot::io {

namespace {

constexpr std::size_t kLinesPerQuery = 8;
constexpr std::size_t kMaxDigits = 2000;

[[noreturn]] void fail(const std::filesystem::path& file, const Lines& lines, const char* what) {
    throw Error(file.string() + ": " + lines.name(),
                what,
                "give numerator,denominator of x, y and z, and 0 or 1 if the truth is known");
}

bool is_whole(std::string_view text, bool may_be_negative) {
    if (may_be_negative && text.starts_with('-')) {
        text.remove_prefix(1);
    }
    return !text.empty() && text.size() <= kMaxDigits &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Digits without leading zeros, which would make them octal.
std::string plain(std::string_view text) {
    const bool is_negative = text.starts_with('-');
    text.remove_prefix(is_negative ? 1 : 0);
    while (text.size() > 1 && text.front() == '0') {
        text.remove_prefix(1);
    }
    return (is_negative ? "-" : "") + std::string(text);
}

}  // namespace

std::vector<ContactQuery> read_contact_queries(const std::filesystem::path& file) {
    const std::string text = read_whole_file(file);
    std::vector<ContactQuery> queries;
    Lines lines(text);
    std::size_t row = 0;
    while (const auto line = lines.next()) {
        if (trimmed(*line).empty()) {
            continue;
        }
        const auto cells = cells_of(*line);
        if (cells.size() != 6 && cells.size() != 7) {
            fail(file, lines, "does not have six or seven values");
        }
        if (row == 0) {
            queries.emplace_back();
        }
        ContactQuery& query = queries.back();
        auto& point = (row < 4 ? query.points.begin : query.points.end)[row % 4];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!is_whole(cells[2 * axis], true) || !is_whole(cells[2 * axis + 1], false)) {
                fail(file, lines, "contains a value that is not a whole number");
            }
            point[axis] = {plain(cells[2 * axis]), plain(cells[2 * axis + 1])};
            if (point[axis].denominator == "0") {
                fail(file, lines, "has a denominator of zero");
            }
        }
        if (cells.size() == 7) {
            if (cells[6] != "0" && cells[6] != "1") {
                fail(file, lines, "has a truth that is neither 0 nor 1");
            }
            query.truth = cells[6] == "1";
        }
        row = (row + 1) % kLinesPerQuery;
    }
    if (row != 0) {
        fail(file, lines, "ends within a query of eight lines");
    }
    return queries;
}

}  // namespace earshot::io
