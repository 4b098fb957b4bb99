// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/scene_view.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Why it is not known from which side a point on a surface is to be taken.
enum class PlacementProblem {
    other_point_in_plane,  ///< the pair's other point lies in the surface's plane too
    edge_of_free_sheet,    ///< the surface ends at the point
};

/// Where a point of a pair is taken to lie.
struct Placement {
    geometry::Vec3 position{0.0};
    std::optional<PlacementProblem> problem{};
    geometry::TriangleId triangle = 0;  ///< of the problem, in the view's mesh
};

/// Takes sources and listeners that lie on surfaces off them. A point on a triangle, or closer to
/// it than the rounding of the scene's coordinates, stands for the limit of points that approach
/// the surface from the side on which the pair's other point lies: it is moved to that side by a
/// distance that is far below the rounding of the coordinates in files, and far above that of the
/// constructions in double precision.
class SurfacePoints {
public:
    /// `max_radius`: the largest distance of a source or listener from the origin, metres.
    SurfacePoints(const SceneView& scene, double max_radius);

    /// The triangles that the point lies on, ascending.
    std::vector<geometry::TriangleId> triangles_at(const geometry::Vec3& point) const;

    /// `triangles`: triangles_at(point). A point that is on no triangle stays where it is.
    Placement place(const geometry::Vec3& point,
                    std::span<const geometry::TriangleId> triangles,
                    const geometry::Vec3& other) const;

private:
    struct Constraint;

    geometry::Vec3 move_off(const geometry::Vec3& point,
                            std::span<const Constraint> constraints,
                            const geometry::Vec3& other) const;
    bool is_at_free_edge(const geometry::Vec3& point, const geometry::Facet& sheet) const;
    std::vector<geometry::TriangleId> triangles_within(const geometry::Vec3& point,
                                                       double distance) const;

    SceneView scene_;
    double min_height_;
};

/// The listeners for which the source is taken to lie at one position.
struct PlacedListeners {
    geometry::Vec3 source{0.0};
    std::vector<std::size_t> numbers;       ///< ascending, as asked for
    std::vector<geometry::Vec3> positions;  ///< one per number
};

/// A point for which it is not known from which side it is to be taken.
struct UndecidedPoint {
    bool is_source = false;    ///< else it is the listener
    std::size_t listener = 0;  ///< of the pair
    PlacementProblem problem = PlacementProblem::other_point_in_plane;
    geometry::TriangleId triangle = 0;
};

/// A source and its listeners, each placed with respect to the other.
struct PlacedPairs {
    std::vector<PlacedListeners> groups;  ///< in the order of their first listeners
    bool is_moved = false;                ///< some point is not where it was asked for
    std::optional<UndecidedPoint> undecided{};
};

PlacedPairs place_pairs(const SceneView& scene,
                        const geometry::Vec3& source,
                        std::span<const geometry::Vec3> listeners);

/// The same where no point lies on a surface.
PlacedPairs pairs_in_the_air(const geometry::Vec3& source,
                             std::span<const geometry::Vec3> listeners);

}  // namespace earshot::frustum
