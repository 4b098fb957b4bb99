// SPDX-License-Identifier: MIT
#include "earshot/io/internal/ply_header.h"

#include "earshot/base/error.h"
#include "earshot/io/internal/text.h"

#include <algorithm>
#include <array>
#include <utility>

namespace earshot::io {
namespace {

PlyType type_named(std::string_view name, const std::string& file) {
    constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{
        {"char", PlyType::int8},
        {"int8", PlyType::int8},
        {"uchar", PlyType::uint8},
        {"uint8", PlyType::uint8},
        {"short", PlyType::int16},
        {"int16", PlyType::int16},
        {"ushort", PlyType::uint16},
        {"uint16", PlyType::uint16},
        {"int", PlyType::int32},
        {"int32", PlyType::int32},
        {"uint", PlyType::uint32},
        {"uint32", PlyType::uint32},
        {"float", PlyType::float32},
        {"float32", PlyType::float32},
        {"double", PlyType::float64},
        {"float64", PlyType::float64},
    }};
    for (const auto& [known, type] : kTypes) {
        if (name == known) {
            return type;
        }
    }
    throw Error(file,
                "its header has a property of type \"" + std::string(name.substr(0, 24)) + "\"",
                "export it with PLY's own types");
}

PlyFormat format_named(std::string_view name, const std::string& file) {
    if (name == "ascii") {
        return PlyFormat::ascii;
    }
    if (name == "binary_little_endian") {
        return PlyFormat::little_endian;
    }
    if (name == "binary_big_endian") {
        return PlyFormat::big_endian;
    }
    throw Error(file, "its format is none of PLY's", "export it as ascii or binary PLY");
}

PlyElement parse_element(std::string_view rest, const std::string& file) {
    PlyElement element;
    element.name = take_word(rest);
    const auto count = to_integer(take_word(rest));
    if (!count || *count < 0) {
        throw Error(file, "its header has an element without a count", "export the file again");
    }
    element.count = static_cast<std::uint64_t>(*count);
    return element;
}

PlyProperty parse_property(std::string_view rest, const std::string& file) {
    PlyProperty property;
    std::string_view type = take_word(rest);
    if (type == "list") {
        property.is_list = true;
        property.count_type = type_named(take_word(rest), file);
        type = take_word(rest);
    }
    property.type = type_named(type, file);
    property.name = take_word(rest);
    return property;
}

/// The fewest bytes an element can take: one digit and a blank per number in text, empty lists.
std::uint64_t min_element_bytes(const PlyElement& element, PlyFormat format) {
    std::uint64_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
        const PlyType first = property.is_list ? property.count_type : property.type;
        bytes += format == PlyFormat::ascii ? 2 : ply_size(first);
    }
    return bytes;
}

void check_counts(const PlyHeader& header, std::size_t size, const std::string& file) {
    for (const PlyElement& element : header.elements) {
        const std::uint64_t each = min_element_bytes(element, header.format);
        // The last number of a text may lack the blank after it.
        if (element.count == 0) {
            continue;
        }
        if (each == 0 || element.count > (size - header.size + 1) / each) {
            throw Error(file,
                        "claims " + std::to_string(element.count) + " elements \"" +
                            element.name.substr(0, 24) + "\", for which it is too short",
                        "copy or export the file again");
        }
    }
}

}  // namespace

std::size_t ply_size(PlyType type) noexcept {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::float64:
            return 8;
        default:
            return 4;
    }
}

PlyHeader parse_ply_header(std::string_view bytes, const std::string& file) {
    PlyHeader header;
    bool has_format = false;
    Lines lines(bytes);
    if (trimmed(lines.next().value_or("")) != "ply") {
        throw Error(file, "does not begin with ply", "export it as PLY");
    }
    // Where lines end in a carriage return alone, a line feed after the last belongs to the body.
    const std::string_view first_end =
        bytes.substr(std::min(bytes.find_first_of("\r\n"), bytes.size()));
    const bool ends_in_return = first_end.starts_with('\r') && !first_end.starts_with("\r\n");
    while (const auto line = lines.next()) {
        std::string_view rest = *line;
        const std::string_view keyword = take_word(rest);
        if (keyword == "format") {
            header.format = format_named(take_word(rest), file);
            has_format = true;
        } else if (keyword == "element") {
            header.elements.push_back(parse_element(rest, file));
        } else if (keyword == "property" && !header.elements.empty()) {
            header.elements.back().properties.push_back(parse_property(rest, file));
        } else if (keyword == "end_header" && has_format) {
            const auto line_end =
                static_cast<std::size_t>(line->data() + line->size() - bytes.data());
            const bool has_both = !ends_in_return && bytes.substr(line_end).starts_with("\r\n");
            header.size = std::min(line_end + (has_both ? 2U : 1U), bytes.size());
            header.lines = lines.number();
            check_counts(header, bytes.size(), file);
            return header;
        } else if (keyword == "comment" || keyword == "obj_info") {
            header.stated_unit = header.stated_unit ? header.stated_unit : unit_in_comment(rest);
        } else if (!keyword.empty()) {
            throw Error(file,
                        "its header has a line that PLY does not know: " + lines.name(),
                        "correct the header");
        }
    }
    throw Error(file, "its header does not end", "copy or export the file again");
}

}  // namespace earshot::io
