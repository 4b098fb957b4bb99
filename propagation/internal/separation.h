// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/types.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Which closed surfaces of a mesh enclose points, decided exactly. A closed surface is a set of
/// triangles in which every edge has an even number of them: any way between its inside and its
/// outside crosses it, whatever it looks like.
class Separation {
public:
    static constexpr std::uint32_t kNone = 0xffffffffU;

    /// `surface_of_triangle`: the number of the closed surface, or kNone.
    Separation(const bvh::MeshBvh& bvh, std::span<const std::uint32_t> surface_of_triangle);

    /// Where a point is.
    struct Enclosure {
        std::vector<std::uint32_t> inside;      ///< surfaces around the point, ascending
        std::vector<std::uint32_t> on_surface;  ///< surfaces that it lies on, ascending
        friend bool operator==(const Enclosure&, const Enclosure&) = default;
    };

    /// By the parity of crossings with a segment that ends outside of the mesh, on signs of exact
    /// determinants. Nothing if every one of several segments meets an edge.
    std::optional<Enclosure> enclosure(const geometry::Vec3& point) const;

    /// Ascending: the triangles of `candidates` that a surface parts from all `points`: these are
    /// all on one side of it, the triangle is on the other and does not touch it.
    std::vector<geometry::TriangleId> separated(std::span<const geometry::TriangleId> candidates,
                                                std::span<const geometry::Vec3> points) const;

private:
    bool add_crossings(const geometry::Segment& segment, Enclosure& enclosure) const;

    bvh::MeshBvh bvh_;
    std::span<const std::uint32_t> surface_of_triangle_;
};

}  // namespace earshot::propagation
