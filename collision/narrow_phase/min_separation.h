// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"

#include <optional>

namespace earshot::collision {

struct MinSeparationOptions {
    /// Features this close along every axis are in contact, in the unit of the coordinates; >= 0.
    double min_separation = 0.0;
    /// Features up to this much farther apart may count as closer, in the same unit; > 0.
    double tolerance = 1e-6;
};

/// A lower bound of the first time at which the first point is as close to the triangle of the
/// other three as asked; nothing only if it certainly stays farther away. Inclusion-based root
/// finding (Snyder 1992; Wang et al. 2021): boxes of time and barycentric coordinates are split
/// until they certainly contain no contact or are smaller than the tolerance, the earliest first.
/// After 200,000 boxes the earliest remaining one is the answer. Coordinates of up to 1e100.
std::optional<double> vertex_face_min_separation_ccd(const MovingPoints& points,
                                                     const MinSeparationOptions& options);

/// The same for the segments of the first two points and of the last two.
std::optional<double> edge_edge_min_separation_ccd(const MovingPoints& points,
                                                   const MinSeparationOptions& options);

}  // namespace earshot::collision
