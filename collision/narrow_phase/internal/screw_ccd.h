// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/rigid_motion.h"
#include "earshot/geometry/types.h"

#include <array>
#include <optional>

namespace earshot::collision {

/// Four points, the first ones of one body and the others of another. A body moves on a screw, or
/// its points on straight lines from `begin` to `end`.
struct ScrewPoints {
    std::array<geometry::Vec3, 4> begin{};
    std::array<geometry::Vec3, 4> end{};  ///< of points without a screw
    const Screw* first = nullptr;
    const Screw* second = nullptr;

    /// Where point `i` is; `first_points` of the four belong to the first body.
    geometry::Vec3 at(std::size_t i, std::size_t first_points, double time) const noexcept;
};

/// A lower bound of the first time at which the first point and the triangle of the other three are
/// as close as `min_separation` along every axis; nothing only if they never are. Whether they come
/// that close is decided up to 1e-9 of the extent of their motion. Conservative subdivision of
/// time: over a short interval a screw deviates from its chord by at most r angle^2 / 8 (Redon,
/// Kheddar and Coquillart 2002 bound it by interval arithmetic), so an interval is free of contact
/// if the chords keep that distance in addition; else it is halved, the earlier half first. After
/// 10,000 intervals the beginning of the earliest one that is left counts.
std::optional<double> vertex_face_screw_ccd(const ScrewPoints& points, double min_separation);

/// The same for the segments of the first two points and of the last two.
std::optional<double> edge_edge_screw_ccd(const ScrewPoints& points, double min_separation);

}  // namespace earshot::collision
