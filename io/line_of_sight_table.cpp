// SPDX-License-Identifier: MIT
#include "earshot/io/line_of_sight_table.h"

#include "earshot/io/internal/json_lines.h"

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

void append_row(std::span<const visibility::VisibleShare> shares, bool errors, std::string& text) {
    for (std::size_t i = 0; i < shares.size(); ++i) {
        const std::string share = json_number(shares[i].share);
        text += i == 0 ? "" : ",";
        text += errors ? "[" + share + "," + json_number(shares[i].error) + "]" : share;
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

void LineOfSightCsv::add_row(std::span<const std::uint8_t> seen) {
    append_row(seen, text_);
    text_ += '\n';
}

void LineOfSightCsv::add_row(std::span<const TriangleId> blockers) {
    append_row(blockers, "", text_);
    text_ += '\n';
}

void LineOfSightCsv::add_row(std::span<const visibility::VisibleShare> shares) {
    append_row(shares, false, text_);
    text_ += '\n';
}

LineOfSightJson::LineOfSightJson(std::string_view scene, const visibility::PointSets& points)
    : lines_(std::make_unique<JsonLines>()) {
    lines_->begin_list("{\"version\":1,\"scene\":" + json_text(scene) +
                           ",\n\"from\":" + to_json(points.from).dump() +
                           ",\n\"to\":" + to_json(points.to).dump() + ",\n\"frames\":",
                       1);
}

LineOfSightJson::~LineOfSightJson() = default;

void LineOfSightJson::begin_frame(double time, SightRows rows) {
    lines_->add_record("{\"time\":" + json_number(time));
    lines_->begin_list(rows == SightRows::visible    ? ",\"visible\":"
                       : rows == SightRows::blockers ? ",\"blockers\":"
                                                     : ",\"shares\":",
                       2);
}

void LineOfSightJson::add_row(std::span<const std::uint8_t> seen) {
    std::string row = "[";
    append_row(seen, row);
    lines_->add_record(row + "]");
}

void LineOfSightJson::add_row(std::span<const TriangleId> blockers) {
    std::string row = "[";
    append_row(blockers, "null", row);
    lines_->add_record(row + "]");
}

void LineOfSightJson::add_row(std::span<const visibility::VisibleShare> shares) {
    std::string row = "[";
    append_row(shares, true, row);
    lines_->add_record(row + "]");
}

void LineOfSightJson::end_frame() {
    lines_->end_list();
    lines_->append("}");
}

std::string LineOfSightJson::finish() {
    lines_->end_list();
    return lines_->finish();
}

}  // namespace earshot::io
