// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/io/internal/picture_projection.h"
#include "earshot/visibility/exclusion_mask.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::io {

/// A straight line of a drawing, and a triangle that it belongs to.
struct PictureLine {
    glm::dvec2 from{0.0}, to{0.0};
    geometry::TriangleId triangle = 0;
};

/// The feature edges of a mesh as far as no triangle hides them; of excluded triangles, none.
std::vector<PictureLine> visible_edges(const bvh::MeshBvh& bvh,
                                       std::span<const std::uint32_t> labels,
                                       const visibility::ExclusionMask& excluded,
                                       const PictureProjection& projection,
                                       Executor& executor);

/// Where the triangles outside of the mask meet the cut of a plan.
std::vector<PictureLine> section_lines(const geometry::MeshView& mesh,
                                       const visibility::ExclusionMask& excluded,
                                       const PictureProjection& projection);

}  // namespace earshot::io
