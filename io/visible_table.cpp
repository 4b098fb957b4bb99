// SPDX-License-Identifier: MIT
#include "earshot/io/visible_table.h"

#include "earshot/base/math.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

namespace earshot::io {

using visibility::VisibleTriangle;
using visibility::VisibleTriangles;

namespace {

using Json = nlohmann::ordered_json;

/// With the fewest digits that read back as the same double.
std::string digits(double value) {
    return Json(value).dump();
}

std::string digits(const geometry::Vec3& v) {
    return digits(v.x) + "," + digits(v.y) + "," + digits(v.z);
}

std::string json_string(std::string_view text) {
    return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::vector<MaterialShare> shares_of_materials(const VisibleTriangles& visible,
                                               const propagation::Scene& scene) {
    std::vector<MaterialShare> shares(scene.materials.size());
    for (std::size_t i = 0; i < shares.size(); ++i) {
        shares[i].material = static_cast<std::uint32_t>(i);
    }
    for (const VisibleTriangle& entry : visible.triangles) {
        MaterialShare& share = shares[scene.material_of_triangle[entry.triangle]];
        ++share.triangles;
        share.solid_angle += entry.solid_angle;
    }
    std::erase_if(shares, [](const MaterialShare& share) { return share.triangles == 0; });
    std::sort(shares.begin(), shares.end(), [](const MaterialShare& a, const MaterialShare& b) {
        return a.solid_angle != b.solid_angle ? a.solid_angle > b.solid_angle
                                              : a.material < b.material;
    });
    return shares;
}

std::string encode_visible_csv(const VisibleTriangles& visible) {
    std::string text = "triangle,pixels,solid_angle,x,y,z\n";
    for (const VisibleTriangle& entry : visible.triangles) {
        text += std::to_string(entry.triangle) + "," + std::to_string(entry.pixels) + "," +
                digits(entry.solid_angle) + "," + digits(entry.direction) + "\n";
    }
    return text;
}

VisibleJson::VisibleJson(const propagation::Scene& scene,
                         const geometry::Vec3& point,
                         double resolution)
    : scene_(scene),
      text_("{\"version\":1,\"scene\":" + json_string(scene.name) + ",\n\"point\":[" +
            digits(point) + "],\n\"resolution\":" + digits(resolution * 180.0 / math::kPi) +
            ",\n\"frames\":[") {}

void VisibleJson::add_frame(double time, const VisibleTriangles& visible) {
    text_ += std::exchange(is_first_, false) ? "\n" : ",\n";
    text_ += " {\"time\":" + digits(time) + ",\"rays\":" + std::to_string(visible.rays) +
             ",\"complete\":" + (visible.is_complete ? "true" : "false") +
             ",\"free_solid_angle\":" + digits(visible.free_solid_angle) + ",\n  \"materials\":[";
    const char* separator = "\n";
    for (const MaterialShare& share : shares_of_materials(visible, scene_)) {
        text_ += separator + std::string("   {\"material\":") +
                 json_string(scene_.materials[share.material].name) +
                 ",\"triangles\":" + std::to_string(share.triangles) +
                 ",\"solid_angle\":" + digits(share.solid_angle) + "}";
        separator = ",\n";
    }
    text_ += "],\n  \"triangles\":[";
    separator = "\n";
    for (const VisibleTriangle& entry : visible.triangles) {
        const std::uint32_t material = scene_.material_of_triangle[entry.triangle];
        text_ += separator + std::string("   {\"triangle\":") + std::to_string(entry.triangle) +
                 ",\"material\":" + json_string(scene_.materials[material].name) +
                 ",\"pixels\":" + std::to_string(entry.pixels) +
                 ",\"solid_angle\":" + digits(entry.solid_angle) + ",\"direction\":[" +
                 digits(entry.direction) + "]}";
        separator = ",\n";
    }
    text_ += "]}";
}

std::string VisibleJson::finish() {
    text_ += "]}\n";
    return std::move(text_);
}

}  // namespace earshot::io
