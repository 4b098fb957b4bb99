// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <compare>
#include <cstdint>
#include <string_view>

namespace earshot::collision {

enum class ContactKind { vertex_face, edge_edge, triangle_triangle };

/// The name of a kind in contacts.json.
std::string_view name_of(ContactKind kind) noexcept;

/// A mesh element: a vertex, an edge or a face, as one, two or three vertices of a mesh, ascending.
struct Element {
    std::uint32_t mesh = 0;
    std::uint32_t size = 0;  ///< number of vertices
    std::array<geometry::VertexId, 3> vertices{};

    friend auto operator<=>(const Element&, const Element&) = default;
};

/// Two elements in contact: a vertex and a face or two edges (a < b) during a step, or two faces
/// (a < b) at its beginning.
struct Contact {
    ContactKind kind = ContactKind::vertex_face;
    Element a, b;
    double toi = 0.0;  ///< within the step, 0 ... 1, never later than the true time of impact
    /// The point of contact on a at that time, metres; of two faces the middle of their
    /// intersection.
    geometry::Vec3 point{0.0};
    /// Unit normal of b's face, or of both edges, on the side that a comes from (of two faces: the
    /// side of a's centroid); zero where there is none.
    geometry::Vec3 normal{0.0};
};

/// By time, then kind, then elements.
bool operator<(const Contact& x, const Contact& y) noexcept;

}  // namespace earshot::collision
