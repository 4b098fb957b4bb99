// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/visible_triangle_set.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace earshot::io {

class JsonLines;

/// The part of one material that is visible from a point.
struct MaterialShare {
    std::uint32_t material = 0;  ///< index into the scene's materials
    std::size_t triangles = 0;   ///< of it that are visible
    double solid_angle = 0.0;    ///< steradians of the whole sphere's 4 pi
};

/// The shares of all visible materials, the largest solid angle first, equal ones by index.
std::vector<MaterialShare> shares_of_materials(const visibility::VisibleTriangles& visible,
                                               const propagation::Scene& scene);

/// A table with the header `triangle,pixels,solid_angle,x,y,z` and a line per triangle.
std::string encode_visible_csv(const visibility::VisibleTriangles& visible);

/// Writes visible triangles as JSON, with names and shares of materials, for one instant or
/// several.
class VisibleJson {
public:
    /// `resolution`: of the sweep, radians; written in degrees.
    VisibleJson(const propagation::Scene& scene, const geometry::Vec3& point, double resolution);
    ~VisibleJson();
    VisibleJson(const VisibleJson&) = delete;
    VisibleJson& operator=(const VisibleJson&) = delete;

    void add_frame(double time, const visibility::VisibleTriangles& visible);
    /// To be called once, after the last instant.
    std::string finish();

private:
    const propagation::Scene& scene_;
    std::unique_ptr<JsonLines> lines_;
};

}  // namespace earshot::io
