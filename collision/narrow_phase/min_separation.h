// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/narrow_phase/ccd.h"

#include <optional>

namespace earshot::collision {

struct MinSeparationOptions {
    /// Points count as in contact when they are so near along every axis, in the unit of the
    /// coordinates; >= 0.
    double min_separation = 0.0;
    /// How far apart points may be that are taken for nearer, in the same unit; > 0.
    double tolerance = 1e-6;
};

/// A lower bound of the first time at which the first point comes as near to the triangle of the
/// other three as asked; nothing only if it certainly stays farther away. By inclusion (Snyder
/// 1992; Wang et al. 2021): boxes of time and place are divided until they are seen to hold nothing
/// or are smaller than the tolerance, the earliest first. After 200,000 boxes the earliest that
/// is left counts. Coordinates of up to 1e100.
std::optional<double> vertex_face_min_separation_ccd(const MovingPoints& points,
                                                     const MinSeparationOptions& options);

/// The same of the segments of the first two points and of the last two.
std::optional<double> edge_edge_min_separation_ccd(const MovingPoints& points,
                                                   const MinSeparationOptions& options);

}  // namespace earshot::collision
