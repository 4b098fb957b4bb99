// SPDX-License-Identifier: MIT
#include "earshot/collision/contact.h"

#include <tuple>

namespace earshot::collision {

std::string_view name_of(ContactKind kind) noexcept {
    return kind == ContactKind::vertex_face ? "vertex_face" : "edge_edge";
}

bool operator<(const Contact& x, const Contact& y) noexcept {
    return std::tie(x.toi, x.kind, x.a, x.b) < std::tie(y.toi, y.kind, y.a, y.b);
}

}  // namespace earshot::collision
