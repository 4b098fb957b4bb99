// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/coherent_order.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>

namespace earshot::visibility {

using geometry::Segment;
using geometry::Vec3;

namespace {

constexpr std::size_t kGrain = 8192;

// Two passes over 12 bits each sort by this many.
constexpr unsigned kKeyBits = 24;

struct Bounds {
    Vec3 lower{std::numeric_limits<double>::infinity()};
    Vec3 upper{-std::numeric_limits<double>::infinity()};

    void include(const Vec3& point) {
        lower = glm::min(lower, point);
        upper = glm::max(upper, point);
    }
};

/// A grid of 2^bits cells per axis over a box.
class Grid {
public:
    Grid(const Bounds& bounds, unsigned bits) : lower_(bounds.lower), last_((1U << bits) - 1) {
        for (int axis = 0; axis < 3; ++axis) {
            const double width = bounds.upper[axis] - bounds.lower[axis];
            scale_[axis] = width > 0.0 ? static_cast<double>(1U << bits) / width : 0.0;
        }
    }

    std::array<std::uint32_t, 3> cell_of(const Vec3& point) const {
        std::array<std::uint32_t, 3> cell{};
        for (int axis = 0; axis < 3; ++axis) {
            const double steps = (point[axis] - lower_[axis]) * scale_[axis];
            cell[static_cast<std::size_t>(axis)] =
                std::min(static_cast<std::uint32_t>(steps), last_);
        }
        return cell;
    }

private:
    Vec3 lower_, scale_{0.0};
    std::uint32_t last_;
};

/// The bits of all coordinates in turn, highest first.
template <std::size_t kAxes>
std::uint32_t interleaved(const std::array<std::uint32_t, kAxes>& cell) {
    std::uint32_t key = 0;
    for (unsigned bit = kKeyBits / kAxes; bit-- > 0;) {
        for (const std::uint32_t coordinate : cell) {
            key = key << 1U | (coordinate >> bit & 1U);
        }
    }
    return key;
}

/// Indices sorted by key, stable (a radix sort from the low digit on).
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& keys) {
    constexpr unsigned kDigitBits = 12;
    constexpr std::uint32_t kMask = (1U << kDigitBits) - 1;
    std::vector<std::uint32_t> order(keys.size());
    std::vector<std::uint32_t> next(keys.size());
    std::iota(order.begin(), order.end(), 0U);
    for (unsigned shift = 0; shift < kKeyBits; shift += kDigitBits) {
        std::array<std::uint32_t, kMask + 2> begin{};
        for (const std::uint32_t key : keys) {
            ++begin[(key >> shift & kMask) + 1];
        }
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        for (const std::uint32_t index : order) {
            next[begin[keys[index] >> shift & kMask]++] = index;
        }
        order.swap(next);
    }
    return order;
}

template <typename KeyOf>
std::vector<std::uint32_t> order_of(std::size_t count, Executor& executor, const KeyOf& key_of) {
    std::vector<std::uint32_t> keys(count);
    executor.for_each(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            keys[i] = key_of(i);
        }
    });
    return sorted_by(keys);
}

}  // namespace

std::vector<std::uint32_t> coherent_order(std::span<const Vec3> points, Executor& executor) {
    Bounds bounds;
    for (const Vec3& point : points) {
        bounds.include(point);
    }
    const Grid grid(bounds, kKeyBits / 3);
    return order_of(points.size(), executor, [&](std::size_t i) {
        return interleaved(grid.cell_of(points[i]));
    });
}

std::vector<std::uint32_t> coherent_order(std::span<const Segment> segments, Executor& executor) {
    Bounds bounds;
    for (const Segment& segment : segments) {
        bounds.include(segment.from);
        bounds.include(segment.to);
    }
    const Grid grid(bounds, kKeyBits / 6);
    return order_of(segments.size(), executor, [&](std::size_t i) {
        const auto from = grid.cell_of(segments[i].from);
        const auto to = grid.cell_of(segments[i].to);
        return interleaved(std::array{from[0], from[1], from[2], to[0], to[1], to[2]});
    });
}

}  // namespace earshot::visibility
