// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/label_layout.h"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace earshot::visibility {

/// One side of the interior area: x, times -1 on the right, as a convex function of y.
class InteriorSide {
public:
    InteriorSide(std::vector<glm::dvec2> points, bool is_left);

    /// x of the boundary; beyond the first and the last row as there.
    double x(double y) const noexcept { return sign_ * value(y); }

    /// x of the line outside of which no row from `first` to `last` has interior area.
    double clear_x(double first, double last) const noexcept;

    double top() const noexcept { return hull_.front().y; }
    double bottom() const noexcept { return hull_.back().y; }

private:
    double value(double y) const noexcept;

    double sign_;
    std::vector<glm::dvec2> hull_;
};

/// The interior area: the convex hull of the drawing with its margin.
class LabelInterior {
public:
    /// Precondition: there are points.
    explicit LabelInterior(std::vector<glm::dvec2> points);

    const InteriorSide& side(bool is_left) const noexcept { return is_left ? left_ : right_; }

    double diagonal() const noexcept;

    /// Grows until rows from `first` to `last` have interior area.
    void include_rows(double first, double last);

private:
    std::vector<glm::dvec2> points_;
    InteriorSide left_, right_;
};

/// Corners whose convex hull is the interior area; none without a drawing.
std::vector<glm::dvec2> interior_points(const IdImage& image,
                                        std::span<const LabelledObject> objects,
                                        double margin);

}  // namespace earshot::visibility
