// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/coincident_materials.h"

#include "earshot/frustum/layer_overlaps.h"

#include <glm/geometric.hpp>

#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::TriangleId;
using geometry::Vec3;

struct Claim {
    double area = 0.0;
    Vec3 point{0.0};  // of the first place found
};

std::string words(const Claim& claim) {
    std::ostringstream text;
    text.precision(3);
    text << claim.area << " m2, such as at ";
    text.precision(6);
    text << "(" << claim.point.x + 0.0 << ", " << claim.point.y + 0.0 << ", " << claim.point.z + 0.0
         << ")";
    return text.str();
}

}  // namespace

Warnings coincident_materials(const Scene& scene,
                              const frustum::SceneView& view,
                              std::span<const TriangleId> kept,
                              std::span<const geometry::DuplicateTriangle> duplicates) {
    using Materials = std::pair<std::uint32_t, std::uint32_t>;  // that counts, that does not
    std::map<Materials, Claim> claims;
    const auto add = [&](TriangleId first, TriangleId second, double area, const Vec3& point) {
        const Materials materials = {scene.material_of_triangle[first],
                                     scene.material_of_triangle[second]};
        if (materials.first != materials.second) {
            Claim& claim = claims.try_emplace(materials, Claim{0.0, point}).first->second;
            claim.area += area;
        }
    };
    std::vector<std::uint32_t> labels;
    for (const TriangleId triangle : kept) {
        labels.push_back(scene.material_of_triangle[triangle]);
    }
    for (const frustum::LayerOverlap& overlap : find_layer_overlaps(view, labels)) {
        add(kept[overlap.first], kept[overlap.second], overlap.area, overlap.point);
    }
    for (const geometry::DuplicateTriangle& pair : duplicates) {
        const auto [a, b, c] = scene.mesh.triangles()[pair.duplicate];
        const auto& p = view.mesh().positions;
        const double area = 0.5 * glm::length(glm::cross(p[b] - p[a], p[c] - p[a]));
        add(pair.kept, pair.duplicate, area, (p[a] + p[b] + p[c]) / 3.0);
    }
    Warnings warnings;
    for (const auto& [materials, claim] : claims) {
        const std::string& first = scene.materials[materials.first].name;
        const std::string& second = scene.materials[materials.second].name;
        warnings.push_back({scene.name,
                            "materials " + first + " and " + second + " lie in one place over " +
                                words(claim) + "; " + first +
                                " counts there, as the first in the file"});
    }
    return warnings;
}

}  // namespace earshot::propagation
