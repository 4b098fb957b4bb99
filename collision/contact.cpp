// SPDX-License-Identifier: MIT
#include "earshot/collision/contact.h"

#include <tuple>

namespace earshot::collision {

std::string_view name_of(ContactKind kind) noexcept {
    switch (kind) {
        case ContactKind::vertex_face:
            return "vertex_face";
        case ContactKind::edge_edge:
            return "edge_edge";
        case ContactKind::triangle_triangle:
            break;
    }
    return "triangle_triangle";
}

bool operator<(const Contact& x, const Contact& y) noexcept {
    return std::tie(x.toi, x.kind, x.a, x.b) < std::tie(y.toi, y.kind, y.a, y.b);
}

}  // namespace earshot::collision
