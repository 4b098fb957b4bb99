// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

using Direction = std::array<double, 3>;

/// A direction as the weighted mean of given ones; those of weight 0 do not count.
struct DirectionWeights {
    std::array<std::size_t, 3> index{};
    std::array<double, 3> weight{};  ///< >= 0; their sum is 1
};

/// Triangles between given directions: the convex hull of points on the unit sphere, which is their
/// Delaunay triangulation. Directions that lie between none of them, where a set covers a part of
/// the sphere or a single plane, are taken for the closest direction on its border.
class DirectionTriangulation {
public:
    /// Precondition: unit vectors, at least one. Of equal ones the first counts.
    explicit DirectionTriangulation(std::span<const Direction> directions);

    /// Of the triangle that a unit vector passes through: barycentric weights of where it does. One
    /// direction alone within 1e-6 rad of it.
    DirectionWeights weights(const Direction& direction) const;

    /// The share of the sphere that each direction stands for, a third of each of its triangles'
    /// solid angles; their sum is 1. Equal shares if there are no triangles.
    std::vector<double> sphere_shares() const;

private:
    struct Triangle {
        std::array<std::size_t, 3> corners;
        // The weights of a direction before they are scaled: its product with each row.
        std::array<Direction, 3> rows;
    };

    void add_triangles(std::span<const std::array<std::size_t, 3>> hull);
    void add_ring(std::span<const std::size_t> distinct);
    std::optional<DirectionWeights> weights_in_triangle(const Direction& direction) const;
    DirectionWeights weights_on_border(const Direction& direction,
                                       const DirectionWeights& closest) const;

    std::vector<Direction> directions_;
    std::vector<Triangle> triangles_;
    std::vector<std::array<std::size_t, 2>> border_;  // edges
    std::vector<double> solid_angles_;                // per direction
};

}  // namespace earshot::audio
