// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/geometry/aabb.h"
#include "earshot/geometry/types.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace earshot::frustum {

/// Where the connecting leg to a subpath of a listener runs: unfolded, it passes the aperture of
/// the subpath's first facet and ends in the listener's image.
struct SubpathBounds {
    geometry::Aabb aperture;
    geometry::Aabb image;
};

/// The legs from one image source through an aperture, in single precision.
struct ConnectingLegs {
    /// Of a mirrored frustum. `plane`: where it starts; `position_error`: of images, metres;
    /// `max_coordinate`: of the subpaths' bounds.
    ConnectingLegs(const Frustum& reflected,
                   const geometry::Plane& plane,
                   double position_error,
                   double max_coordinate,
                   double max_length) noexcept;

    float apex[3];
    float axes[3][3];  ///< right, up, forward
    float lower[2], upper[2];
    float normal[3];  ///< of the plane, towards the side of the legs
    float offset;
    float margin;  ///< metres: boxes grow by it
    float min_depth, max_length;
};

/// Eight pairs of boxes, side by side.
struct alignas(64) SubpathBlock {
    static constexpr std::size_t kWidth = 8;
    struct Box {
        float lower[3][kWidth];
        float upper[3][kWidth];
    };
    Box aperture, image;
};

/// The bounds of subpaths in a hierarchy of eight children per node. The tree is complete: child i
/// of node k on a level is node 8 k + i on the level below, and the lowest level are the subpaths.
class SubpathTree {
public:
    SubpathTree() = default;
    explicit SubpathTree(std::span<const SubpathBounds> subpaths);

    /// Appends the numbers of a superset of the subpaths that a leg may connect, in an order that
    /// depends on the subpaths alone. The same numbers on every instruction set.
    void find(const ConnectingLegs& legs, std::vector<std::uint32_t>& found) const;

    /// The largest absolute coordinate of the bounds.
    double max_coordinate() const noexcept { return max_coordinate_; }

    /// A level of the tree, the lowest first; its nodes are the bounds [first, first + count).
    struct Level {
        std::size_t first_block = 0;
        std::size_t count = 0;
    };
    std::span<const Level> levels() const noexcept { return levels_; }
    std::span<const SubpathBlock> blocks() const noexcept { return blocks_; }

    /// The numbers of the subpaths on the lowest level.
    std::span<const std::uint32_t> numbers() const noexcept { return numbers_; }

private:
    std::vector<SubpathBounds> add_level(std::span<const SubpathBounds> nodes);

    std::vector<Level> levels_;
    std::vector<SubpathBlock> blocks_;
    std::vector<std::uint32_t> numbers_;
    double max_coordinate_ = 0.0;
};

}  // namespace earshot::frustum
