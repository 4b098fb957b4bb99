// SPDX-License-Identifier: MIT
#include "earshot/io/internal/ply_records.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace earshot::io {
namespace {

constexpr const char* kCopyAgain = "copy or export the file again";

template <typename T>
T as(const std::array<char, 8>& bytes) noexcept {
    T value{};
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
}

double as_number(const std::array<char, 8>& bytes, PlyType type) noexcept {
    switch (type) {
        case PlyType::int8:
            return as<std::int8_t>(bytes);
        case PlyType::uint8:
            return as<std::uint8_t>(bytes);
        case PlyType::int16:
            return as<std::int16_t>(bytes);
        case PlyType::uint16:
            return as<std::uint16_t>(bytes);
        case PlyType::int32:
            return as<std::int32_t>(bytes);
        case PlyType::uint32:
            return as<std::uint32_t>(bytes);
        case PlyType::float32:
            return static_cast<double>(as<float>(bytes));
        case PlyType::float64:
            return as<double>(bytes);
    }
    return 0.0;
}

/// Reads the properties of one element. `next(type)` gives the next number, `max_count(type)` the
/// numbers that can be left, so that a claimed length is refused before it is believed.
template <typename Next, typename MaxCount, typename Fail>
void read_properties(const PlyElement& element,
                     const PlyProperty* wanted,
                     const Next& next,
                     const MaxCount& max_count,
                     const Fail& fail_length,
                     PlyRecord& record) {
    record.scalars.clear();
    record.list.clear();
    for (const PlyProperty& property : element.properties) {
        const double number = next(property.is_list ? property.count_type : property.type);
        record.scalars.push_back(property.is_list ? 0.0 : number);
        if (!property.is_list) {
            continue;
        }
        if (!(number >= 0.0) || number > static_cast<double>(max_count(property.type))) {
            fail_length();
        }
        for (auto remaining = static_cast<std::size_t>(number); remaining > 0; --remaining) {
            const double item = next(property.type);
            if (&property == wanted) {
                record.list.push_back(item);
            }
        }
    }
}

[[noreturn]] void fail_list(const std::string& file) {
    throw Error(file, "has a list of a length that it is too short for", kCopyAgain);
}

[[noreturn]] void fail_number(const std::string& file,
                              const std::string& what,
                              std::string_view word) {
    throw Error(file,
                what + "has \"" + shortened(word) + "\" in place of a number",
                "export the file again");
}

}  // namespace

void BinaryPlyRecords::read(const PlyElement& element,
                            const PlyProperty* wanted,
                            PlyRecord& record) {
    read_properties(
        element,
        wanted,
        [&](PlyType type) { return next(type); },
        [&](PlyType type) { return rest_.size() / ply_size(type); },
        [&] { fail_list(file_); },
        record);
}

double BinaryPlyRecords::next(PlyType type) {
    const std::size_t size = ply_size(type);
    if (rest_.size() < size) {
        throw Error(file_, "is truncated", kCopyAgain);
    }
    std::array<char, 8> bytes{};
    std::copy_n(rest_.begin(), size, bytes.begin());
    rest_.remove_prefix(size);
    if (format_ == PlyFormat::big_endian) {
        std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return as_number(bytes, type);
}

void BinaryPlyRecords::finish(Warnings& warnings) {
    if (!rest_.empty()) {
        warnings.push_back(
            {file_, std::to_string(rest_.size()) + " bytes after the last element are left out"});
    }
}

bool LinePlyRecords::next_line() {
    while (const auto line = lines_.next()) {
        line_ = trimmed(*line);
        if (!line_.empty()) {
            return true;
        }
    }
    return false;
}

double LinePlyRecords::next(std::string_view& line, const PlyElement& element) const {
    const std::string_view word = take_word(line);
    if (word.empty()) {
        throw Short(
            file_, where() + " is too short for a \"" + shortened(element.name) + "\"", kCopyAgain);
    }
    const auto number = to_number(word);
    if (!number) {
        fail_number(file_, where() + " ", word);
    }
    return *number;
}

void LinePlyRecords::read(const PlyElement& element, const PlyProperty* wanted, PlyRecord& record) {
    if (!next_line()) {
        throw Short(
            file_, "there are fewer lines than vertices, faces and other elements", kCopyAgain);
    }
    read_properties(
        element,
        wanted,
        [&](PlyType) { return next(line_, element); },
        [&](PlyType) { return line_.size() / 2 + 1; },
        [&] { throw Short(file_, where() + " is too short for the list in it", kCopyAgain); },
        record);
    if (trimmed(line_).empty()) {
        return;
    }
    if (surplus_.empty() || surplus_.back().element != element.name) {
        surplus_.push_back({.element = element.name, .where = where(), .count = 1});
    } else {
        ++surplus_.back().count;
    }
}

void LinePlyRecords::finish(Warnings& warnings) {
    if (next_line()) {
        throw Error(file_,
                    where() + ": \"" + shortened(line_) +
                        "\" follows the last element that the header counts",
                    "correct the counts of the header, or export the file again");
    }
    for (const Surplus& surplus : surplus_) {
        warnings.push_back({file_,
                            std::to_string(surplus.count) + " lines of the element \"" +
                                shortened(surplus.element) +
                                "\" hold more values than the header names, the first is " +
                                surplus.where + "; what is too many is left out"});
    }
}

std::string_view StreamPlyRecords::next_word() {
    const auto is_blank = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
    const auto* begin = std::find_if_not(rest_.begin(), rest_.end(), is_blank);
    const auto* end = std::find_if(begin, rest_.end(), is_blank);
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.begin()));
    return {begin, static_cast<std::size_t>(end - begin)};
}

double StreamPlyRecords::next() {
    const std::string_view word = next_word();
    if (word.empty()) {
        throw Error(file_, "is truncated", kCopyAgain);
    }
    const auto number = to_number(word);
    if (!number) {
        fail_number(file_, "", word);
    }
    return *number;
}

void StreamPlyRecords::read(const PlyElement& element,
                            const PlyProperty* wanted,
                            PlyRecord& record) {
    read_properties(
        element,
        wanted,
        [&](PlyType) { return next(); },
        [&](PlyType) { return rest_.size() / 2 + 1; },
        [&] { fail_list(file_); },
        record);
}

void StreamPlyRecords::finish(Warnings&) {
    if (const std::string_view word = next_word(); !word.empty()) {
        throw Error(file_,
                    "has \"" + shortened(word) + "\" after the last element that the header counts",
                    "correct the counts of the header, or export the file again");
    }
}

}  // namespace earshot::io
