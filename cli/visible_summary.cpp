// SPDX-License-Identifier: MIT
#include "earshot/cli/visible_summary.h"

#include "earshot/base/math.h"
#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"
#include "earshot/cli/update_summary.h"
#include "earshot/cli/visible_picture.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace earshot::cli {

namespace {

std::string colour_name(std::size_t material) {
    return name_of(colour_of(static_cast<std::uint32_t>(material)));
}

std::string table_row(double share, const std::string& triangles, const std::string& name) {
    return formatted("%8.2f %%  %9s  ", 100.0 * share, triangles.c_str()) + on_one_line(name) +
           "\n";
}

}  // namespace

VisibleSummary::VisibleSummary(const propagation::Scene& scene)
    : scene_(scene), seen_(scene.mesh.triangles().size()), solid_angles_(scene.materials.size()) {}

void VisibleSummary::add_frame(const visibility::VisibleTriangles& visible) {
    for (const visibility::VisibleTriangle& entry : visible.triangles) {
        seen_[entry.triangle] = true;
        solid_angles_[scene_.material_of_triangle[entry.triangle]] += entry.solid_angle;
    }
    free_solid_angle_ += visible.free_solid_angle;
    rays_ += visible.rays;
    is_complete_ = is_complete_ && visible.is_complete;
    ++instants_;
}

std::string VisibleSummary::json(const Outputs& outputs) const {
    using Json = nlohmann::ordered_json;
    Json materials = Json::array();
    for (const Row& row : rows()) {
        materials.push_back({{"material", scene_.materials[row.material].name},
                             {"triangles", row.triangles},
                             {"share", row.share}});
        if (outputs.picture.shows_materials()) {
            materials.back()["colour"] = colour_name(row.material);
        }
    }
    const geometry::Vec3& point = outputs.point;
    Json json = {{"version", 1},
                 {"point", {point.x, point.y, point.z}},
                 {"instants", instants_},
                 {"triangles", triangles_seen()},
                 {"rays", rays_},
                 {"complete", is_complete_},
                 {"hierarchy", update_json(updates_)},
                 {"free", share(free_solid_angle_)},
                 {"materials", materials},
                 {"seconds", outputs.seconds}};
    if (!outputs.file.empty()) {
        json["file"] = outputs.file;
    }
    if (outputs.picture.is_chosen()) {
        json["image"] = outputs.picture.file();
    }
    if (outputs.picture.depth_range()) {
        json["depth_range"] = *outputs.picture.depth_range();
    }
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string VisibleSummary::text(const Outputs& outputs) const {
    std::string text = "triangles  " + std::to_string(triangles_seen()) + " of " +
                       std::to_string(seen_.size()) + " are seen\nrays       " +
                       std::to_string(rays_) + "\n";
    if (!is_complete_) {
        text += "           which were not enough: some triangles may be missing\n";
    }
    text += "\n of sphere  triangles  material\n";
    for (const Row& row : rows()) {
        const std::string colour =
            outputs.picture.shows_materials() ? "  " + colour_name(row.material) : "";
        text += table_row(
            row.share, std::to_string(row.triangles), scene_.materials[row.material].name + colour);
    }
    text += table_row(share(free_solid_angle_), "", "(nothing)");
    text += formatted("\ntime       %.3f s\n", outputs.seconds);
    text += outputs.file.empty() ? "" : "file       " + outputs.file + "\n";
    text += outputs.picture.is_chosen() ? "image      " + outputs.picture.file() + "\n" : "";
    if (outputs.picture.depth_range()) {
        text += formatted("darkest    %.6g m\n", *outputs.picture.depth_range());
    }
    return text;
}

std::vector<VisibleSummary::Row> VisibleSummary::rows() const {
    std::vector<Row> rows(scene_.materials.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i] = {.material = i, .share = share(solid_angles_[i])};
    }
    for (std::size_t i = 0; i < seen_.size(); ++i) {
        rows[scene_.material_of_triangle[i]].triangles += seen_[i] ? 1 : 0;
    }
    std::erase_if(rows, [](const Row& row) { return row.triangles == 0; });
    std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
        return a.share != b.share ? a.share > b.share : a.material < b.material;
    });
    return rows;
}

std::size_t VisibleSummary::triangles_seen() const {
    return static_cast<std::size_t>(std::count(seen_.begin(), seen_.end(), true));
}

double VisibleSummary::share(double solid_angle) const {
    return solid_angle / (4.0 * math::kPi * static_cast<double>(instants_));
}

}  // namespace earshot::cli
