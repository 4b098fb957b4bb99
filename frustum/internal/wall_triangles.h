// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/scene_view.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::frustum {

/// The triangles of one facet, looked up by position: a grid over the two axes along which the
/// plane extends most, whose cells hold the triangles that they may touch.
class WallTriangles {
public:
    WallTriangles(const SceneView& scene, geometry::FacetId facet);

    /// The lowest triangle that contains a point of the plane, borders included.
    std::optional<geometry::TriangleId> at(const geometry::Vec3& point) const;

private:
    struct Candidate {
        geometry::TriangleId triangle = 0;
        std::array<glm::dvec2, 3> corner;
    };
    struct Cell {
        std::uint32_t begin = 0;
        std::uint32_t count = 0;
        bool is_covered = false;  ///< by its only triangle
    };

    struct Rectangle {
        glm::dvec2 lower{0.0}, upper{0.0};
    };

    std::size_t coordinate(double position, int axis) const noexcept;
    Rectangle rectangle(std::size_t cell) const noexcept;
    void add_to_cells(std::uint32_t index, std::vector<std::vector<std::uint32_t>>& lists) const;
    static bool may_touch(const Candidate& candidate,
                          const glm::dvec2& lower,
                          const glm::dvec2& upper) noexcept;
    static bool covers(const Candidate& candidate,
                       const glm::dvec2& lower,
                       const glm::dvec2& upper) noexcept;

    int axis_;  ///< that is dropped
    glm::dvec2 lower_{0.0}, cells_per_metre_{0.0}, cell_size_{0.0};
    std::size_t side_;  ///< cells along an axis
    std::vector<Candidate> triangles_;
    std::vector<Cell> cells_;
    std::vector<std::uint32_t> listed_;  ///< indices into triangles_, ascending per cell
};

}  // namespace earshot::frustum
