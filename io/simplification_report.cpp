// SPDX-License-Identifier: MIT
#include "earshot/io/simplification_report.h"

#include "earshot/io/internal/json_lines.h"

#include <cmath>
#include <utility>

namespace earshot::io {
namespace {

using Json = nlohmann::ordered_json;
using geometry::Vec3;
using namespace propagation;

Json vector_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// "31.5", "1000".
std::string key_of(double frequency_hz) {
    return std::floor(frequency_hz) == frequency_hz
               ? std::to_string(static_cast<long>(frequency_hz))
               : json_number(frequency_hz);
}

Json octaves_of(const audio::Spectrum& values) {
    Json json = Json::object();
    const audio::Bands& bands = audio::Bands::octaves();
    for (std::size_t band = 0; band < bands.count(); ++band) {
        json[key_of(bands.nominal_hz()[band])] = values[band];
    }
    return json;
}

Json distance_of(const bvh::SurfaceDistance& distance) {
    return {{"lower", distance.lower}, {"upper", distance.upper}, {"rms", distance.rms}};
}

Json change_of(const SurfaceChange& change) {
    return {{"to_simplified", distance_of(change.to_simplified)},
            {"to_original", distance_of(change.to_original)}};
}

Json before_and_after(const Json& before, const Json& after) {
    return {{"before", before}, {"after", after}};
}

Json number_or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json head_of(const SimplificationReportParts& parts) {
    const SimplificationReport& report = parts.model.report;
    constexpr double kDegrees = 57.29577951308232;
    return {
        {"version", 1},
        {"scene", parts.model.scene.name},
        {"distance", parts.options.max_distance},
        {"angle_deg", kDegrees * parts.options.max_angle},
        {"object_size", parts.options.max_object_size},
        {"triangles", before_and_after(report.triangles_before, report.triangles_after)},
        {"vertices", before_and_after(report.vertices_before, report.vertices_after)},
        {"dropped_triangles", report.dropped_triangles},
        {"parts", report.parts},
        {"parts_tightened", report.parts_tightened},
        {"parts_kept", report.parts_kept},
        {"surfaces", change_of(report.surfaces)},
        {"boxes", change_of(report.boxes)},
        {"solid_volume", before_and_after(report.solid_volume_before, report.solid_volume_after)},
        {"absorption_area",
         before_and_after(octaves_of(report.absorption_area_before),
                          octaves_of(report.absorption_area_after))},
        {"max_rounding", report.max_rounding},
        {"seconds", parts.seconds}};
}

std::vector<Json> materials_of(const SimplificationReportParts& parts) {
    std::vector<Json> list;
    for (std::size_t i = 0; i < parts.model.report.materials.size(); ++i) {
        const MaterialChange& change = parts.model.report.materials[i];
        list.push_back(
            {{"name", parts.model.scene.materials[i].name},
             {"triangles", before_and_after(change.triangles_before, change.triangles_after)},
             {"area", before_and_after(change.area_before, change.area_after)},
             {"absorption_area",
              before_and_after(octaves_of(change.absorption_area_before),
                               octaves_of(change.absorption_area_after))},
             {"removed_depth", change.removed_depth},
             {"new_data", change.has_new_data},
             {"limited", change.is_limited}});
    }
    return list;
}

std::vector<Json> objects_of(const SimplificationReportParts& parts) {
    std::vector<Json> list;
    for (const ReplacedObject& object : parts.model.report.objects) {
        list.push_back({{"mesh", object.mesh},
                        {"triangles", object.triangles},
                        {"centre", vector_of(object.box.centre)},
                        {"size", vector_of(2.0 * object.box.half_size)},
                        {"material", parts.model.scene.materials[object.material].name},
                        {"distance", change_of(object.change)}});
    }
    return list;
}

std::vector<Json> close_emitters_of(const SimplificationReportParts& parts) {
    std::vector<Json> list;
    for (const CloseEmitter& close : parts.model.report.close_emitters) {
        const Scene& scene = parts.model.scene;
        list.push_back(
            {{"kind", close.is_source ? "source" : "listener"},
             {"name", (close.is_source ? scene.sources : scene.listeners)[close.index].name},
             {"distance", close.distance}});
    }
    return list;
}

Json metric_of(const PairComparison& pair, const audio::BandMetricKind& kind) {
    return {{"before", number_or_null(pair.before.*kind.value)},
            {"after", number_or_null(pair.after.*kind.value)},
            {"standard_error",
             before_and_after(number_or_null(pair.error_before.*kind.value),
                              number_or_null(pair.error_after.*kind.value))},
            {"jnd", number_or_null(noticeable_difference(kind, pair.before, pair.after))}};
}

std::vector<Json> pairs_of(const SimplificationReportParts& parts) {
    std::vector<Json> list;
    for (const PairComparison& pair : parts.comparison->pairs) {
        Json json = {{"source", parts.model.scene.sources[pair.source].name},
                     {"listener", parts.model.scene.listeners[pair.listener].name},
                     {"paths", before_and_after(pair.paths_before, pair.paths_after)}};
        for (const audio::BandMetricKind& kind : audio::kBandMetricKinds) {
            json[std::string(kind.key) + "_mid"] = metric_of(pair, kind);
        }
        list.push_back(std::move(json));
    }
    return list;
}

}  // namespace

std::string encode_simplification_report(const SimplificationReportParts& parts) {
    Json head = head_of(parts);
    if (parts.comparison != nullptr) {
        const ModelComparison& comparison = *parts.comparison;
        head["compared_seconds"] = {
            {"paths",
             before_and_after(comparison.path_seconds_before, comparison.path_seconds_after)},
            {"all", before_and_after(comparison.seconds_before, comparison.seconds_after)}};
    }
    JsonLines lines;
    std::string text = json_text(head);
    text.pop_back();
    lines.append(text);
    lines.add_list("materials", materials_of(parts));
    lines.add_list("objects", objects_of(parts));
    lines.add_list("close_emitters", close_emitters_of(parts));
    if (parts.comparison != nullptr) {
        lines.add_list("pairs", pairs_of(parts));
    }
    return lines.finish();
}

}  // namespace earshot::io
