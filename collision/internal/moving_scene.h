// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/swept_dop.h"
#include "earshot/collision/contact.h"
#include "earshot/collision/narrow_phase/ccd.h"
#include "earshot/collision/narrow_phase/internal/screw_ccd.h"
#include "earshot/geometry/mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::collision {

/// A range of indices.
struct IndexRange {
    std::uint32_t begin = 0, end = 0;
};

/// The meshes of a World, their vertices one after the other and their triangles likewise.
struct MovingScene {
    std::vector<geometry::Vec3> begin, end;
    std::vector<geometry::Triangle> triangles;
    std::vector<std::uint32_t> mesh_of_triangle;
    std::vector<geometry::VertexId> first_vertex{0};  ///< of each mesh, and one beyond
    std::vector<std::size_t> first_triangle{0};       ///< likewise

    std::vector<std::optional<Screw>> screws;  ///< of meshes that do not move on chords
    std::vector<double> deviation;             ///< by vertex, bound from its chord, metres
    std::uint32_t meshes_on_screws = 0;

    /// By mesh: a number that grows whenever it moves otherwise than in the step before.
    std::vector<std::uint64_t> revisions;

    std::uint64_t layout = 0;              ///< grows with every mesh that is added or removed
    std::vector<std::uint8_t> is_removed;  ///< by mesh

    std::uint32_t meshes() const noexcept {
        return static_cast<std::uint32_t>(first_vertex.size() - 1);
    }

    /// Throws Error if a triangle names a vertex that is not there.
    void add(std::span<const geometry::Triangle> mesh, std::size_t vertices);

    /// Takes out the vertices and triangles of a mesh, which keeps its number.
    void remove(std::uint32_t mesh);

    /// The mesh moves from `begin` to `end`, or on a screw. Coordinates below
    /// geometry::kMinCoordinate count as 0. Returns whether it begins elsewhere than before. Throws
    /// Error if a position is not finite. Precondition: as many positions as vertices.
    bool move(std::uint32_t mesh,
              std::span<const geometry::Vec3> from,
              std::span<const geometry::Vec3> to);
    bool move(std::uint32_t mesh, std::span<const geometry::Vec3> from, const Screw& screw);

    std::span<const geometry::Triangle> triangles_of(std::uint32_t mesh) const noexcept;
    IndexRange vertex_range(std::uint32_t mesh) const noexcept;
    IndexRange triangle_range(std::uint32_t mesh) const noexcept;
    MovingCorners corners_of(const geometry::Triangle& triangle) const noexcept;
    /// The points on their chords.
    MovingPoints points_of(const std::array<geometry::VertexId, 4>& vertices) const noexcept;
    /// Points of meshes that move alike are at rest relative to each other if on a screw.
    void rest_if_on_screw(std::uint32_t mesh, MovingPoints& points) const noexcept;

    /// Bound of how far a triangle's points deviate from their chords, metres.
    double deviation_of(const geometry::Triangle& triangle) const noexcept;

    /// Whether points of two meshes have to be tested on screws: one of the meshes moves on a screw
    /// and the other does not move with it.
    bool on_screws(std::uint32_t mesh_a, std::uint32_t mesh_b) const noexcept;
    ScrewPoints screw_points_of(const std::array<geometry::VertexId, 4>& vertices,
                                std::uint32_t mesh_a,
                                std::uint32_t mesh_b) const noexcept;

    Element element(std::uint32_t mesh, std::span<const geometry::VertexId> vertices) const;
    /// Sets the point and normal of a contact between these vertices, given its kind and time.
    void set_point_and_normal(const std::array<geometry::VertexId, 4>& vertices,
                              Contact& contact) const;

private:
    bool set_begin(std::uint32_t mesh, std::span<const geometry::Vec3> positions);
    const Screw* screw_of(std::uint32_t mesh) const noexcept {
        return screws[mesh] ? &*screws[mesh] : nullptr;
    }
};

}  // namespace earshot::collision
