// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/path_frames.h"
#include "earshot/propagation/unfolded_path.h"

#include <cstddef>
#include <map>
#include <vector>

namespace earshot::propagation {

/// The facets that paths met, known by the paths alone: the normal of a reflection halves the angle
/// between its directions, and triangles in one plane are one facet.
class PathFacets {
public:
    /// Throws Error if the plane of a reflection does not follow from its points.
    explicit PathFacets(const PathFrames& frames);

    /// Of the triangles that paths of the instant met.
    FacetTable at(std::size_t instant) const;

private:
    /// A plane as the points of a path tell it.
    struct Observation {
        geometry::Plane plane{};
        geometry::Vec3 point{0.0};  ///< on it
        /// How far points may be moved by rounding until the normal is off by as much: the shorter
        /// leg times the change of direction, metres. The largest wins.
        double quality = 0.0;
    };
    struct Surface {
        geometry::TriangleId first_triangle = 0;  ///< of its facet
        Observation best{};
        bool is_fixed = false;  ///< `best` holds at all instants
        bool reflects = false;
        std::map<std::size_t, Observation> at{};  ///< by instant, the best of each
    };
    void observe(std::size_t instant, const Path& path);
    static void add(std::size_t instant, const Observation& observation, Surface& surface);
    void finish(geometry::TriangleId triangle, Surface& surface) const;
    bool agree(const Observation& best, const Observation& observation) const;
    void join_fixed();
    void join_moving();

    const PathFrames& frames_;
    std::map<geometry::TriangleId, Surface> surfaces_;
    double extent_ = 1.0;  // the largest coordinate, metres
};

}  // namespace earshot::propagation
