// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <optional>

namespace earshot::collision {

/// Four points that move on straight lines: x(t) = begin + t (end - begin), 0 <= t <= 1, in exact
/// arithmetic. Coordinates are finite.
struct MovingPoints {
    std::array<geometry::Vec3, 4> begin{};
    std::array<geometry::Vec3, 4> end{};
};

/// Continuous collision detection of a vertex and a face: the time of impact of the first point and
/// the closed triangle of the other three, or nothing if there is no contact. Whether there is a
/// contact is decided exactly. The time is never later than the true time of impact, and earlier by
/// at most 2^-40 (2^-50 if the decision needed exact arithmetic). Triangles may degenerate to
/// segments or points at any time. Signs of Bernstein coefficients and subdivision with proven
/// error bounds decide nearly all queries (Tang et al. 2014; Wang et al. 2021 for the problem), and
/// arbitrary-precision integers decide the rest: see docs/algorithms/collision.md.
std::optional<double> vertex_face_ccd(const MovingPoints& points);

/// The same for two edges: the closed segments of the first two points and of the last two.
std::optional<double> edge_edge_ccd(const MovingPoints& points);

}  // namespace earshot::collision
