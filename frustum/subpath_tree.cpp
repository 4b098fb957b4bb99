// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/subpath_tree.h"

#include "earshot/base/parallel.h"
#include "earshot/frustum/internal/subpath_order.h"
#include "earshot/geometry/facets.h"
#include "earshot/geometry/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace earshot::frustum {

using geometry::Aabb;
using geometry::Vec3;

namespace {

constexpr std::size_t kWidth = SubpathBlock::kWidth;

/// Relative to the coordinates: boxes grow by so much, which is more than the rounding of where
/// they lie to a half-space, and in quotients more than theirs (docs/algorithms/frustum.md).
constexpr double kBoxRounding = 0x1p-17;

/// All directions of an aperture that is projected advance at least so far along the axis, at a
/// length of 1 to 1.8.
constexpr double kMinAdvance = 1.0 / 8.0;

void set_box(SubpathBlock::Box& box, std::size_t lane, const Aabb& value) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.lower[k][lane] = value.lower[k];
        box.upper[k][lane] = value.upper[k];
    }
}

}  // namespace

// A point p of a leg is apex + t d for a direction d = forward + u right + v up of the aperture.
ConnectingLegs::ConnectingLegs(const Frustum& reflected,
                               const geometry::Plane& plane,
                               double position_error,
                               double max_coordinate,
                               double longest) noexcept {
    double farthest = 0.0;
    for (int k = 0; k < 3; ++k) {
        farthest = std::max(farthest, std::abs(reflected.apex[k]));
    }
    const double margin = kBoxRounding * (max_coordinate + farthest) + position_error;
    for (int k = 0; k < 3; ++k) {
        low_apex[k] = geometry::round_down(reflected.apex[k] - margin);
        high_apex[k] = geometry::round_up(reflected.apex[k] + margin);
    }
    max_length = geometry::round_up(longest);
    add_half_space(reflected.side * plane.normal, reflected.side * plane.offset, margin);
    project(reflected);
    const auto follows_axis = [](const Vec3& direction) {
        constexpr double kAlmostOne = 1.0 - 0x1p-20;
        return geometry::max_abs(direction) > kAlmostOne;
    };
    if (axis >= 0 && follows_axis(reflected.forward) && follows_axis(reflected.right)) {
        return;  // the sides tell no more than the projected aperture
    }
    const auto add_side = [&](const Vec3& normal) {
        add_half_space(normal, glm::dot(normal, reflected.apex), margin);
    };
    add_side(reflected.right - reflected.rect.lower.x * reflected.forward);
    add_side(reflected.rect.upper.x * reflected.forward - reflected.right);
    add_side(reflected.up - reflected.rect.lower.y * reflected.forward);
    add_side(reflected.rect.upper.y * reflected.forward - reflected.up);
}

void ConnectingLegs::add_half_space(const Vec3& towards, double offset, double margin) noexcept {
    HalfSpace& half_space = half_spaces[half_space_count++];
    double norm = 0.0;
    for (int k = 0; k < 3; ++k) {
        half_space.normal[k] = static_cast<float>(towards[k]);
        norm += std::abs(towards[k]);
    }
    half_space.offset = geometry::round_down(offset - margin * norm);
}

// Projects the aperture from the apex along the coordinate axis that all of its directions follow
// the most. A direction is a sum of the corners' directions with positive weights, so its quotients
// lie between those of the corners.
void ConnectingLegs::project(const Frustum& reflected) noexcept {
    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Rect& rect = reflected.rect;
        corners[i] = reflected.forward +
                     (i % 2 == 0 ? rect.lower.x : rect.upper.x) * reflected.right +
                     (i / 2 == 0 ? rect.lower.y : rect.upper.y) * reflected.up;
    }
    double min_advance = kMinAdvance;
    for (int k = 0; k < 3; ++k) {
        for (const double direction : {1.0, -1.0}) {
            double advance = std::numeric_limits<double>::infinity();
            for (const Vec3& corner : corners) {
                advance = std::min(advance, direction * corner[k]);
            }
            if (advance > min_advance) {
                min_advance = advance;
                axis = k;
                sign = static_cast<float>(direction);
            }
        }
    }
    if (axis < 0) {
        return;
    }
    for (int k = 0; k < 2; ++k) {
        const int across = (axis + 1 + k) % 3;
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        for (const Vec3& corner : corners) {
            const double quotient = corner[across] / std::abs(corner[axis]);
            low = std::min(low, quotient);
            high = std::max(high, quotient);
        }
        lower[k] = geometry::round_down(low);
        upper[k] = geometry::round_up(high);
    }
    constexpr double kRoundedDown = 1.0 - 0x1p-40;
    min_depth = geometry::round_down(kRoundedDown * min_advance * reflected.min_depth);
}

SubpathTree::SubpathTree(std::span<const SubpathBounds> subpaths, Executor& executor)
    : SubpathTree(
          subpaths,
          subpaths.empty() ? std::vector<std::uint32_t>{} : order_subpaths(subpaths, executor),
          executor) {}

SubpathTree::SubpathTree(std::span<const SubpathBounds> subpaths,
                         std::vector<std::uint32_t> order,
                         Executor& executor)
    : numbers_(std::move(order)) {
    if (subpaths.empty()) {
        return;
    }
    for (const SubpathBounds& bounds : subpaths) {
        max_coordinate_ = std::max({max_coordinate_,
                                    bounds.aperture.max_abs_coordinate(),
                                    bounds.image.max_abs_coordinate()});
    }
    std::size_t block_count = 0;
    std::size_t count = subpaths.size();
    do {
        levels_.push_back({block_count, count});
        count = chunk_count(count, kWidth);
        block_count += count;
    } while (count > 1);
    blocks_.resize(block_count);
    // The subpaths, then the nodes around each block of the level below.
    std::vector<SubpathBounds> nodes(subpaths.size());
    constexpr std::size_t kGrain = 4096;
    executor.for_each(nodes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            nodes[i] = subpaths[numbers_[i]];
        }
    });
    for (const Level& level : levels_) {
        nodes = fill_level(level, nodes, executor);
    }
}

// Returns the bounds of the blocks.
std::vector<SubpathBounds> SubpathTree::fill_level(const Level& level,
                                                   std::span<const SubpathBounds> nodes,
                                                   Executor& executor) {
    std::vector<SubpathBounds> around(chunk_count(nodes.size(), kWidth));
    constexpr std::size_t kGrain = 512;
    executor.for_each(around.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = kWidth * begin; i < std::min(kWidth * end, nodes.size()); ++i) {
            SubpathBlock& block = blocks_[level.first_block + i / kWidth];
            set_box(block.aperture, i % kWidth, nodes[i].aperture);
            set_box(block.image, i % kWidth, nodes[i].image);
            around[i / kWidth].aperture.include(nodes[i].aperture);
            around[i / kWidth].image.include(nodes[i].image);
        }
    });
    return around;
}

}  // namespace earshot::frustum
