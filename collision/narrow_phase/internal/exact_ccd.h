// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"
#include "earshot/collision/narrow_phase/internal/exact_polynomial.h"

#include <array>
#include <optional>

namespace earshot::collision {

/// Four moving points whose coordinates are integer multiples of one unit.
struct IntegerPoints {
    std::array<std::array<Integer, 3>, 4> begin{}, end{};
};

/// The same points exactly.
IntegerPoints integers_of(const MovingPoints& points);

/// As vertex_face_ccd() and edge_edge_ccd(), by arbitrary-precision integers alone.
std::optional<double> exact_vertex_face_ccd(const IntegerPoints& points);
std::optional<double> exact_edge_edge_ccd(const IntegerPoints& points);

}  // namespace earshot::collision
