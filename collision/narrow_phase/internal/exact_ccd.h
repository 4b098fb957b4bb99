// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"
#include "earshot/collision/narrow_phase/internal/exact_polynomial.h"

#include <array>
#include <optional>

namespace earshot::collision {

/// Coordinates of four moving points in whole numbers of one unit: at the beginning, at the end.
struct IntegerPoints {
    std::array<std::array<Integer, 3>, 4> begin{}, end{};
};

/// Exactly the points of doubles.
IntegerPoints integers_of(const MovingPoints& points);

/// As vertex_face_ccd() and edge_edge_ccd(), by integers of any size alone.
std::optional<double> exact_vertex_face_ccd(const IntegerPoints& points);
std::optional<double> exact_edge_edge_ccd(const IntegerPoints& points);

}  // namespace earshot::collision
