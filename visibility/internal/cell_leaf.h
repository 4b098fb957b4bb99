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

/// A maximal free segment with the objects at its ends.
struct VisibilitySample {
    geometry::Vec3 from{};
    geometry::Vec3 step{};  ///< to the other end
    std::array<ObjectId, 2> objects = {kNoObject, kNoObject};
};

/// The part of a visibility sample within a leaf, as parameters along its segment.
struct SamplePiece {
    std::uint32_t sample = 0;
    double begin = 0.0, end = 1.0;
};

/// A sample point of the density of viewers, with the fraction of the viewers it stands for.
struct Viewer {
    geometry::Vec3 position{};
    double fraction = 0.0;
};

/// A leaf while view cells are being built.
struct CellLeaf {
    CellShape shape;
    double volume = 0.0;           ///< cubic metres
    double viewer_fraction = 0.0;  ///< of the viewers
    std::vector<SamplePiece> pieces{};
    std::vector<ObjectId> set{};  ///< the objects at the ends of the samples, ascending
    double set_cost = 0.0;
    std::vector<geometry::TriangleId> triangles{};  ///< near the leaf; empty without a mesh
    std::vector<std::uint32_t> viewers{};           ///< in the leaf; empty without a density
    std::uint64_t key = 0;                          ///< random stream of its triangles
    int poor_splits = 0;
    int depth = 0;
};

/// The extent of a piece along a normal. An end within `slack` of a plane does not reach beyond it,
/// and a piece that lies within the slack of a plane as a whole is on both sides.
struct Extent {
    double at_begin = 0.0, at_end = 0.0;
    double low = 0.0, high = 0.0;  ///< the minimum and the maximum of both
    /// The piece reaches the back of planes of offset >= first, and the front of planes of offset
    /// <= last.
    double first = 0.0, last = 0.0;

    Extent(const VisibilitySample& sample,
           const SamplePiece& piece,
           const geometry::Vec3& normal,
           double slack)
        : at_begin(glm::dot(normal, sample.from + piece.begin * sample.step)),
          at_end(glm::dot(normal, sample.from + piece.end * sample.step)),
          low(std::min(at_begin, at_end)),
          high(std::max(at_begin, at_end)),
          first(std::min(low + slack, high - slack)),
          last(std::max(low + slack, high - slack)) {}
};

}  // namespace earshot::visibility
