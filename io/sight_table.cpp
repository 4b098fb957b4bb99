// SPDX-License-Identifier: MIT
#include "earshot/io/sight_table.h"

#include <nlohmann/json.hpp>

#include <utility>

namespace earshot::io {

using geometry::TriangleId;
using geometry::Vec3;
using visibility::kNoBlocker;

namespace {

using Json = nlohmann::ordered_json;

void append_row(std::span<const std::uint8_t> seen, std::string& text) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
        text += i == 0 ? "" : ",";
        text += seen[i] != 0 ? '1' : '0';
    }
}

void append_row(std::span<const TriangleId> blockers, std::string_view none, std::string& text) {
    for (std::size_t i = 0; i < blockers.size(); ++i) {
        text += i == 0 ? "" : ",";
        text += blockers[i] == kNoBlocker ? std::string(none) : std::to_string(blockers[i]);
    }
}

Json to_json(std::span<const Vec3> points) {
    Json json = Json::array();
    for (const Vec3& point : points) {
        json.push_back({point.x, point.y, point.z});
    }
    return json;
}

}  // namespace

void SightCsv::add_row(std::span<const std::uint8_t> seen) {
    append_row(seen, text_);
    text_ += '\n';
}

void SightCsv::add_row(std::span<const TriangleId> blockers) {
    append_row(blockers, "", text_);
    text_ += '\n';
}

SightJson::SightJson(std::string_view scene, const visibility::SightPoints& points)
    : text_("{\"version\":1,\"scene\":" +
            Json(scene).dump(-1, ' ', false, Json::error_handler_t::replace) +
            ",\n\"from\":" + to_json(points.from).dump() +
            ",\n\"to\":" + to_json(points.to).dump() + ",\n\"frames\":[") {}

void SightJson::begin_frame(double time, bool with_blockers) {
    text_ += is_first_frame_ ? "\n" : ",\n";
    text_ +=
        " {\"time\":" + Json(time).dump() + (with_blockers ? ",\"blockers\":[" : ",\"visible\":[");
    is_first_frame_ = false;
    is_first_row_ = true;
}

void SightJson::add_row(std::span<const std::uint8_t> seen) {
    text_ += std::exchange(is_first_row_, false) ? "\n  [" : ",\n  [";
    append_row(seen, text_);
    text_ += ']';
}

void SightJson::add_row(std::span<const TriangleId> blockers) {
    text_ += std::exchange(is_first_row_, false) ? "\n  [" : ",\n  [";
    append_row(blockers, "null", text_);
    text_ += ']';
}

void SightJson::end_frame() {
    text_ += "]}";
}

std::string SightJson::finish() {
    text_ += "]}\n";
    return std::move(text_);
}

}  // namespace earshot::io
