// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/types.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/simulator.h"
#include "earshot/propagation/trajectory.h"

#include <glm/mat3x3.hpp>

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A triangle of a facet.
struct FacetTriangle {
    geometry::TriangleId triangle = 0;
    geometry::TriangleId first_triangle = 0;  ///< of the facet
    geometry::Plane plane{};                  ///< of the facet
};

/// The facets of a scene at an instant, by the triangles of its file.
class FacetTable {
public:
    explicit FacetTable(const Simulator& simulator, Executor& executor = Executor::serial());
    /// Of some triangles, in ascending order.
    explicit FacetTable(std::span<const FacetTriangle> triangles);

    /// The facet's first triangle, which names it from instant to instant.
    geometry::TriangleId first_triangle(geometry::TriangleId triangle) const;
    const geometry::Plane& plane(geometry::TriangleId triangle) const;

private:
    geometry::FacetId facet_of(geometry::TriangleId triangle) const;

    std::vector<geometry::TriangleId> triangles_;       // ascending; empty: all of the scene
    std::vector<geometry::FacetId> of_triangle_;        // per triangle of those
    std::vector<geometry::TriangleId> first_triangle_;  // per facet
    std::vector<geometry::Plane> planes_;               // likewise
};

/// What a path meets on its way: paths of consecutive instants with equal keys are one path that
/// moves.
struct PathKey {
    std::vector<std::int64_t> elements{};
    friend auto operator<=>(const PathKey&, const PathKey&) = default;
};

PathKey path_key(const Path& path, const FacetTable& facets);

/// linear * point + offset.
struct AffineMap {
    glm::dmat3 linear{1.0};
    geometry::Vec3 offset{0.0};

    geometry::Vec3 operator()(const geometry::Vec3& point) const { return linear * point + offset; }
    friend bool operator==(const AffineMap&, const AffineMap&) = default;
};

/// A path as a function of where its source and its listener are, while the facets and the edge
/// that it meets stay. Mirrored in its facets it is a straight line, or at an edge two: so its
/// length is exact wherever the source moves.
struct UnfoldedPath {
    AffineMap before{};  ///< mirrors the source in all facets, or in those before the edge
    AffineMap after{};   ///< mirrors the edge in the facets after it
    bool has_edge = false;
    std::array<geometry::Vec3, 2> edge{};  ///< end points

    friend bool operator==(const UnfoldedPath&, const UnfoldedPath&) = default;
};

UnfoldedPath unfold(const Path& path, const FacetTable& facets);

/// The rates of an unfolded path that stays.
inline constexpr UnfoldedPath kStillPath{.before = {.linear = glm::dmat3(0.0)},
                                         .after = {.linear = glm::dmat3(0.0)}};

/// An unfolded path and how fast it changes, per second.
struct MovingUnfoldedPath {
    UnfoldedPath value{};
    UnfoldedPath rate = kStillPath;
};

/// The length of a path of which source and listener move.
struct MovingLength {
    double length = 0.0;          ///< metres
    double rate_by_source = 0.0;  ///< metres per second, by the motion of source, facets and edge
    double rate_by_listener = 0.0;
    geometry::Vec3 arrival{0.0};  ///< unit direction of travel at the listener
};

MovingLength length_of(const MovingUnfoldedPath& path,
                       const Motion& source,
                       const Motion& listener);

}  // namespace earshot::propagation
