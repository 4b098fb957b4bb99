// SPDX-License-Identifier: MIT
#include "earshot/io/location.h"

#include "earshot/io/arrivals.h"
#include "earshot/io/internal/json_lines.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using namespace propagation;

Json number_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json vector_of(const geometry::Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

/// To more digits than the value itself has.
Json interval_of(const LocatedValue& value) {
    constexpr double kSteps = 1e8;
    const auto limit = [&](double number) {
        return number_or_null(std::nearbyint(number * kSteps) / kSteps + 0.0);
    };
    return Json::array({limit(value.lower()), limit(value.upper())});
}

Json value_of(const LocatedValue& value) {
    return {{"stated", value.stated},
            {"value", value.value},
            {"error", number_or_null(value.standard_error)},
            {"interval", interval_of(value)},
            {"data_share", value.data_share}};
}

Json point_of(const std::string& name, const LocatedPoint& point) {
    const auto each = [&](const auto& number_of) {
        return Json::array({number_of(point.x), number_of(point.y), number_of(point.z)});
    };
    return {{"name", name},
            {"position", vector_of(point.position())},
            {"stated", vector_of(point.stated())},
            {"error", each([](const LocatedValue& v) { return number_or_null(v.standard_error); })},
            {"interval", each(interval_of)},
            {"data_share", each([](const LocatedValue& v) { return Json(v.data_share); })},
            {"arrivals", point.arrivals}};
}

std::string head_text(const LocationParts& parts) {
    const LocateResult& result = parts.result;
    const auto held_out = median_absolute(parts.held_out);
    const Json median = {{"before", result.median_before},
                         {"after", result.median_after},
                         {"held_out", held_out ? Json(*held_out) : Json(nullptr)}};
    return "{\"version\":1,\"scene\":" + json_text(parts.scene.name) +
           ",\n\"median_error\":" + median.dump() +
           ",\"matched\":" + std::to_string(result.matched) +
           ",\"order\":" + std::to_string(result.specular_order) +
           ",\"converged\":" + (result.converged ? "true" : "false") +
           ",\"rms_move\":" + json_number(result.rms_move) +
           ",\n\"speed_of_sound\":" + value_of(result.speed_of_sound).dump() +
           ",\"temperature_c\":" + json_number(result.temperature_c);
}

void add_points(JsonLines& lines,
                const char* key,
                const std::vector<Emitter>& emitters,
                const std::vector<LocatedPoint>& points,
                const std::vector<LocatedValue>& latencies) {
    lines.begin_list(std::string(",\n\"") + key + "\":", 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        Json json = point_of(emitters[i].name, points[i]);
        if (!latencies.empty()) {
            json["latency"] = value_of(latencies[i]);
        }
        lines.add_record(json_text(json));
    }
    lines.end_list();
}

void add_arrivals(JsonLines& lines, const LocationParts& parts) {
    lines.begin_list(",\n\"arrivals\":", 1);
    for (std::size_t i = 0; i < parts.arrivals.size(); ++i) {
        const MeasuredArrival& measured = parts.arrivals[i];
        const LocatedArrival& located = parts.result.arrivals[i];
        const auto if_matched = [&](const Json& json) {
            return located.is_matched ? json : Json(nullptr);
        };
        Json json = {{"source", parts.scene.sources[measured.source].name},
                     {"listener", parts.scene.listeners[measured.listener].name},
                     {"time", measured.time},
                     {"surfaces", if_matched(surfaces_text(parts.scene, located.triangles))},
                     {"before", if_matched(located.before)},
                     {"after", if_matched(located.after)},
                     {"weight", located.weight}};
        if (!parts.held_out.empty()) {
            json["held_out"] = parts.held_out[i] ? Json(*parts.held_out[i]) : Json(nullptr);
        }
        lines.add_record(json_text(json));
    }
    lines.end_list();
}

}  // namespace

std::string encode_location(const LocationParts& parts) {
    const LocateResult& result = parts.result;
    JsonLines lines;
    lines.append(head_text(parts));
    add_points(lines, "sources", parts.scene.sources, result.sources, result.latencies);
    add_points(lines, "listeners", parts.scene.listeners, result.listeners, {});
    lines.begin_list(",\n\"walls\":", 1);
    for (const LocatedWall& wall : result.walls) {
        lines.add_record(json_text({{"material", parts.scene.materials[wall.material].name},
                                    {"triangle", wall.triangle},
                                    {"normal", vector_of(wall.normal)},
                                    {"offset", value_of(wall.offset)},
                                    {"arrivals", wall.arrivals}}));
    }
    lines.end_list();
    lines.begin_list(",\n\"motions\":", 1);
    for (const CommonMotion& motion : result.motions) {
        lines.add_record(json_text({{"name", motion.name},
                                    {"data_share", motion.data_share},
                                    {"told", motion.is_told_by_data()}}));
    }
    lines.end_list();
    add_arrivals(lines, parts);
    return lines.finish();
}

}  // namespace earshot::io
