// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/neighbours.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/predicates.h"

#include <algorithm>
#include <utility>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;

namespace {

glm::dvec2 flat(const Vec3& p, int axis) noexcept {
    return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
}

int side(const Vec3& a, const Vec3& b, const Vec3& c, int axis) noexcept {
    return geometry::orient2d(flat(a, axis), flat(b, axis), flat(c, axis));
}

bool has_area(const Corners& t) noexcept {
    return side(t[0], t[1], t[2], 0) != 0 || side(t[0], t[1], t[2], 1) != 0 ||
           side(t[0], t[1], t[2], 2) != 0;
}

/// Two triangles that share an edge, and of each the corner beside it: they overlap if they lie in
/// one plane and on one side of the edge.
bool overlap_beside(const Vec3& from, const Vec3& to, const Vec3& one, const Vec3& other) noexcept {
    if (geometry::orient3d(from, to, one, other) != 0) {
        return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (const int here = side(from, to, one, axis); here != 0) {
            return side(from, to, other, axis) == here;
        }
    }
    return false;
}

/// The places of corners with the same vertex, and how many there are.
struct Shared {
    std::array<std::pair<std::size_t, std::size_t>, 9> places{};
    std::size_t count = 0;

    Shared(const Triangle& one, const Triangle& other) noexcept {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (one[i] == other[k]) {
                    places[count++] = {i, k};
                }
            }
        }
    }
};

}  // namespace

bool intersect_beyond_shared_features(const Triangle& one_ids,
                                      const Corners& one,
                                      const Triangle& other_ids,
                                      const Corners& other) noexcept {
    const Shared shared(one_ids, other_ids);
    if (shared.count == 0) {
        return intersect(one, other);
    }
    // From here on no vertex stands twice in a triangle, because each has an area.
    if (!has_area(one) || !has_area(other)) {
        return false;
    }
    const auto [i, k] = shared.places[0];
    const Vec3& one_next = one[(i + 1) % 3];
    const Vec3& one_last = one[(i + 2) % 3];
    const Vec3& other_next = other[(k + 1) % 3];
    const Vec3& other_last = other[(k + 2) % 3];
    if (shared.count == 1) {
        // Both hold, with another shared point, the straight way to it from the shared corner, and
        // on to where it leaves one of them: through the edge opposite the corner.
        return geometry::touches({one_next, one_last}, other[0], other[1], other[2]) ||
               geometry::touches({other_next, other_last}, one[0], one[1], one[2]);
    }
    if (shared.count == 2) {
        const auto [i2, k2] = shared.places[1];
        return overlap_beside(one[i], one[i2], one[3 - i - i2], other[3 - k - k2]);
    }
    return true;
}

}  // namespace earshot::collision
