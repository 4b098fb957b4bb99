// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/cell_shape.h"
#include "earshot/visibility/objects.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace earshot::visibility {

inline constexpr ObjectId kNoObject = std::numeric_limits<ObjectId>::max();

/// A free segment as the builder of view cells needs it.
struct Sight {
    geometry::Vec3 from{};
    geometry::Vec3 step{};  ///< to its other end
    std::array<ObjectId, 2> objects = {kNoObject, kNoObject};
};

/// The part of a sight within a leaf, as parameters along it.
struct SightPiece {
    std::uint32_t sight = 0;
    double begin = 0.0, end = 1.0;
};

/// A point that stands for viewers, and for what part of all of them.
struct Viewer {
    geometry::Vec3 place{};
    double share = 0.0;
};

/// A leaf while view cells are being built.
struct CellLeaf {
    CellShape shape;
    double volume = 0.0;  ///< cubic metres
    double share = 0.0;   ///< of the viewers
    std::vector<SightPiece> pieces{};
    std::vector<ObjectId> set{};  ///< what the pieces' sights end at, ascending
    double set_cost = 0.0;
    std::vector<geometry::TriangleId> triangles{};  ///< that may be inside; only with a mesh
    std::vector<std::uint32_t> viewers{};           ///< only with a density
    std::uint64_t key = 0;                          ///< chooses its triangles
    int poor_splits = 0;
    int depth = 0;
};

/// From where to where a piece reaches along a normal. Ends within `slack` of a plane do not reach
/// beyond it, and a piece that lies within the slack of a plane altogether is on both sides.
struct Reach {
    double at_begin = 0.0, at_end = 0.0;
    double low = 0.0, high = 0.0;    ///< the same in order
    double first = 0.0, last = 0.0;  ///< behind planes of offset >= first, before those <= last

    Reach(const Sight& sight, const SightPiece& piece, const geometry::Vec3& normal, double slack)
        : at_begin(glm::dot(normal, sight.from + piece.begin * sight.step)),
          at_end(glm::dot(normal, sight.from + piece.end * sight.step)),
          low(std::min(at_begin, at_end)),
          high(std::max(at_begin, at_end)),
          first(std::min(low + slack, high - slack)),
          last(std::max(low + slack, high - slack)) {}
};

}  // namespace earshot::visibility
