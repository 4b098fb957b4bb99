// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
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

/// The legs from one image source through an aperture, in single precision. They are described
/// twice, and either way holds more than them: by half-spaces, and by the quotients of coordinates
/// relative to the apex where they are projected along a coordinate axis.
struct ConnectingLegs {
    /// Of a mirrored frustum. `plane`: where it starts; `position_error`: of images, metres;
    /// `max_coordinate`: of the subpaths' bounds.
    ConnectingLegs(const Frustum& reflected,
                   const geometry::Plane& plane,
                   double position_error,
                   double max_coordinate,
                   double max_length) noexcept;

    /// The points with dot(normal, point) >= offset.
    struct HalfSpace {
        float normal[3];
        float offset;
    };

    HalfSpace half_spaces[5];  ///< beyond the plane and, unless the axes suffice, between the sides
    int half_space_count = 0;
    int axis = -1;      ///< along which the aperture is projected; negative: it is too wide for any
    float sign = 1.0F;  ///< of the legs' direction along the axis
    float low_apex[3], high_apex[3];     ///< the apex less and plus a margin, metres
    float lower[2] = {}, upper[2] = {};  ///< quotients of the two axes that follow
    float min_depth = 0.0F;              ///< along the axis: no point of a leg is closer
    float max_length = 0.0F;

private:
    void add_half_space(const geometry::Vec3& towards, double offset, double margin) noexcept;
    void project(const Frustum& reflected) noexcept;
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
    SubpathTree(std::span<const SubpathBounds> subpaths, Executor& executor);

    /// The same with the numbers of the subpaths in a given order, in which neighbours are close.
    SubpathTree(std::span<const SubpathBounds> subpaths,
                std::vector<std::uint32_t> order,
                Executor& executor);

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
    std::vector<SubpathBounds> fill_level(const Level& level,
                                          std::span<const SubpathBounds> nodes,
                                          Executor& executor);

    std::vector<Level> levels_;
    std::vector<SubpathBlock> blocks_;
    std::vector<std::uint32_t> numbers_;
    double max_coordinate_ = 0.0;
};

}  // namespace earshot::frustum
