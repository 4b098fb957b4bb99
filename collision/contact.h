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

/// A vertex, an edge or a face: one, two or three vertices of a mesh, ascending.
struct Element {
    std::uint32_t mesh = 0;
    std::uint32_t size = 0;  ///< vertices that count
    std::array<geometry::VertexId, 3> vertices{};

    friend auto operator<=>(const Element&, const Element&) = default;
};

/// Two elements that touch: a vertex and a face or two edges (a < b) during a step, or two faces (a
/// < b) at its beginning.
struct Contact {
    ContactKind kind = ContactKind::vertex_face;
    Element a, b;
    double toi = 0.0;  ///< within the step, 0 ... 1, never later than the true time of impact
    /// Where, on a, at that time, metres; of two faces the middle of where they meet.
    geometry::Vec3 point{0.0};
    /// Unit vector at right angles to b's face, or to both edges, from b to where a comes from (of
    /// two faces: to a's middle); zero where there is none.
    geometry::Vec3 normal{0.0};
};

/// By time, then kind, then elements.
bool operator<(const Contact& x, const Contact& y) noexcept;

}  // namespace earshot::collision
