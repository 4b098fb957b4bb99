// SPDX-License-Identifier: MIT
#include "earshot/io/internal/json_lines.h"

#include "earshot/base/assert.h"
#include "earshot/io/escape.h"

#include <utility>

namespace earshot::io {

using Json = nlohmann::ordered_json;

std::string json_text(const Json& value) {
    return escape_controls(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string json_number(double value) {
    return Json(value).dump();
}

std::string json_numbers(const geometry::Vec3& v) {
    return json_number(v.x) + "," + json_number(v.y) + "," + json_number(v.z);
}

void JsonLines::begin_list(std::string_view opening, std::size_t indent) {
    text_ += opening;
    text_ += '[';
    lists_.push_back({.indent = indent});
}

void JsonLines::begin_record() {
    EARSHOT_ASSERT(!lists_.empty());
    text_ += std::exchange(lists_.back().is_empty, false) ? "\n" : ",\n";
    text_.append(lists_.back().indent, ' ');
}

void JsonLines::add_record(std::string_view text) {
    begin_record();
    text_ += text;
}

void JsonLines::end_list() {
    EARSHOT_ASSERT(!lists_.empty());
    lists_.pop_back();
    text_ += ']';
}

void JsonLines::add_list(std::string_view name, const nlohmann::ordered_json& records) {
    begin_list(", \"" + std::string(name) + "\": ", 2);
    for (const nlohmann::ordered_json& record : records) {
        add_record(json_text(record));
    }
    end_list();
}

std::string JsonLines::finish(std::string_view closing) {
    EARSHOT_ASSERT(lists_.empty());
    text_ += closing;
    text_ += '\n';
    return std::move(text_);
}

}  // namespace earshot::io
