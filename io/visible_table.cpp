// SPDX-License-Identifier: MIT
#include "earshot/io/visible_table.h"

#include "earshot/base/math.h"
#include "earshot/io/internal/json_lines.h"

#include <algorithm>

namespace earshot::io {

using visibility::VisibleTriangle;
using visibility::VisibleTriangles;

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
                json_number(entry.solid_angle) + "," + json_numbers(entry.direction) + "\n";
    }
    return text;
}

VisibleJson::VisibleJson(const propagation::Scene& scene,
                         const geometry::Vec3& point,
                         double resolution)
    : scene_(scene), lines_(std::make_unique<JsonLines>()) {
    lines_->begin_list("{\"version\":1,\"scene\":" + json_text(scene.name) + ",\n\"point\":[" +
                           json_numbers(point) + "],\n\"resolution\":" +
                           json_number(resolution * 180.0 / math::kPi) + ",\n\"frames\":",
                       1);
}

VisibleJson::~VisibleJson() = default;

void VisibleJson::add_frame(double time, const VisibleTriangles& visible) {
    lines_->add_record("{\"time\":" + json_number(time) +
                       ",\"rays\":" + std::to_string(visible.rays) +
                       ",\"complete\":" + (visible.is_complete ? "true" : "false") +
                       ",\"free_solid_angle\":" + json_number(visible.free_solid_angle));
    lines_->begin_list(",\n  \"materials\":", 3);
    for (const MaterialShare& share : shares_of_materials(visible, scene_)) {
        lines_->add_record("{\"material\":" + json_text(scene_.materials[share.material].name) +
                           ",\"triangles\":" + std::to_string(share.triangles) +
                           ",\"solid_angle\":" + json_number(share.solid_angle) + "}");
    }
    lines_->end_list();
    lines_->begin_list(",\n  \"triangles\":", 3);
    for (const VisibleTriangle& entry : visible.triangles) {
        const std::uint32_t material = scene_.material_of_triangle[entry.triangle];
        lines_->add_record("{\"triangle\":" + std::to_string(entry.triangle) +
                           ",\"material\":" + json_text(scene_.materials[material].name) +
                           ",\"pixels\":" + std::to_string(entry.pixels) +
                           ",\"solid_angle\":" + json_number(entry.solid_angle) +
                           ",\"direction\":[" + json_numbers(entry.direction) + "]}");
    }
    lines_->end_list();
    lines_->append("}");
}

std::string VisibleJson::finish() {
    lines_->end_list();
    return lines_->finish();
}

}  // namespace earshot::io
