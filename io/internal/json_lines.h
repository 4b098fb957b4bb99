// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::io {

/// Compact JSON text. Names come from files and may not be UTF-8: bytes that are not become U+FFFD.
/// Control characters are escaped, those too that JSON lets pass.
std::string json_text(const nlohmann::ordered_json& value);

/// A number with the fewest digits that read back as the same double.
std::string json_number(double value);

/// `x,y,z` as json_number(), without brackets.
std::string json_numbers(const geometry::Vec3& v);

/// A JSON document with one record of a list per line, which people can read and diff;
/// nlohmann-json writes either everything on one line or every number on a line of its own. Lists
/// nest: a record may hold lists of records itself.
class JsonLines {
public:
    /// Appends JSON text as it stands.
    void append(std::string_view text) { text_ += text; }

    /// Appends `opening`, which ends before the bracket, and begins a list there. Its records are
    /// indented by `indent` blanks.
    void begin_list(std::string_view opening, std::size_t indent);

    /// Begins a record of the innermost list on a line of its own; append() continues it.
    void begin_record();
    void add_record(std::string_view text);

    void end_list();

    /// A whole list as the next member of an object that is open: `name` and the records of an
    /// array.
    void add_list(std::string_view name, const nlohmann::ordered_json& records);

    /// The document, `closing` and a line end appended. To be called once, with every list ended.
    std::string finish(std::string_view closing = "}");

private:
    struct List {
        std::size_t indent = 0;
        bool is_empty = true;
    };

    std::string text_;
    std::vector<List> lists_;  // the open ones, the innermost last
};

}  // namespace earshot::io
