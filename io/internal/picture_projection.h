// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/io/scene_picture.h"
#include "earshot/visibility/item_buffer.h"

#include <glm/vec2.hpp>

#include <limits>
#include <span>

namespace earshot::io {

/// The parallel projection of a scene to a drawing: x to the right, y down, from 0 to width() and
/// height(), in the drawing's units.
class PictureProjection {
public:
    /// Units along the longer side of a drawing, and per pixel of an item buffer.
    static constexpr double kSize = 640.0;
    static constexpr double kUnitsPerPixel = 2.0;

    explicit PictureProjection(Projection projection);

    /// Makes room for points. Before any of what follows.
    void include(std::span<const geometry::Vec3> points);
    /// The height of the cut of a plan, metres.
    void set_cut(double y) noexcept { cut_ = y; }

    bool is_plan() const noexcept { return is_plan_; }
    double cut() const noexcept { return cut_; }
    const geometry::Vec3& towards() const noexcept { return towards_; }  ///< the viewer; unit
    double width() const noexcept { return (high_.x - low_.x) * scale(); }
    double height() const noexcept { return (high_.y - low_.y) * scale(); }
    /// Metres across the drawing and along the view: the largest distance in it.
    double extent() const noexcept;

    glm::dvec2 project(const geometry::Vec3& point) const noexcept;

    /// From a point of the scene to the plane that the viewer looks from, begun a little before
    /// the point, so that surfaces which the point lies on do not count.
    geometry::Segment line_of_view(const geometry::Vec3& point) const noexcept;

    /// The view of an item buffer that covers the drawing, and the point that it is rendered from.
    visibility::View view() const noexcept;
    geometry::Vec3 viewpoint() const noexcept;

private:
    double scale() const noexcept;  ///< units per metre
    geometry::Vec3 in_view(const geometry::Vec3& point) const noexcept;

    bool is_plan_;
    geometry::Vec3 right_{0.0}, up_{0.0}, towards_{0.0};
    geometry::Vec3 low_{std::numeric_limits<double>::max()};
    geometry::Vec3 high_{std::numeric_limits<double>::lowest()};  ///< along right_, up_, towards_
    double cut_ = 0.0;
};

}  // namespace earshot::io
