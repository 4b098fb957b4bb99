// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/morton.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace earshot::bvh {

using geometry::Aabb;

namespace {

constexpr std::size_t kGrain = 65536;
constexpr double kCells = 0x1p21;

double doubled_centroid(const Aabb& box, std::size_t axis) noexcept {
    return static_cast<double>(box.lower[axis]) + static_cast<double>(box.upper[axis]);
}

/// Maps centroids to cells along an axis; centroids that are not finite go to the ends.
struct Grid {
    std::array<double, 3> lower{}, scale{};

    std::uint64_t cell(const Aabb& box, std::size_t axis) const noexcept {
        const double cell = (doubled_centroid(box, axis) - lower[axis]) * scale[axis];
        return cell > 0.0 ? static_cast<std::uint64_t>(std::min(cell, kCells - 1.0)) : 0;
    }
};

Grid grid_of(std::span<const Aabb> boxes, Executor& executor) {
    struct Bounds {
        std::array<double, 3> lower, upper;
    };
    std::vector<Bounds> bounds(chunk_count(boxes.size(), kGrain));
    executor.for_each(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Bounds& part = bounds[begin / kGrain];
        part.lower.fill(std::numeric_limits<double>::max());
        part.upper.fill(std::numeric_limits<double>::lowest());
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double c = doubled_centroid(boxes[i], axis);
                if (std::isfinite(c)) {
                    part.lower[axis] = std::min(part.lower[axis], c);
                    part.upper[axis] = std::max(part.upper[axis], c);
                }
            }
        }
    });
    Grid grid;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double lower = std::numeric_limits<double>::max();
        double upper = std::numeric_limits<double>::lowest();
        for (const Bounds& part : bounds) {
            lower = std::min(lower, part.lower[axis]);
            upper = std::max(upper, part.upper[axis]);
        }
        const double scale = kCells / (upper - lower);
        grid.lower[axis] = lower;
        grid.scale[axis] = upper > lower && std::isfinite(scale) ? scale : 0.0;
    }
    return grid;
}

/// Puts two zeros between the lowest 21 bits.
std::uint64_t expand_bits(std::uint64_t bits) noexcept {
    bits = (bits | bits << 32U) & 0x1F00000000FFFFU;
    bits = (bits | bits << 16U) & 0x1F0000FF0000FFU;
    bits = (bits | bits << 8U) & 0x100F00F00F00F00FU;
    bits = (bits | bits << 4U) & 0x10C30C30C30C30C3U;
    return (bits | bits << 2U) & 0x1249249249249249U;
}

constexpr unsigned kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
constexpr unsigned kCodeBits = 63;

/// One stable pass of a radix sort. Every chunk has its own counts and scatters to its own offsets,
/// so the order does not depend on the executor.
void sort_by_digit(std::span<const MortonPrimitive> from,
                   std::span<MortonPrimitive> to,
                   unsigned shift,
                   Executor& executor) {
    using Counts = std::array<std::uint32_t, kDigits>;
    std::vector<Counts> offsets(chunk_count(from.size(), kGrain));
    const auto digit_of = [&](const MortonPrimitive& primitive) {
        return primitive.code >> shift & (kDigits - 1);
    };
    executor.for_each(from.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Counts& counts = offsets[begin / kGrain];
        counts.fill(0);
        for (std::size_t i = begin; i < end; ++i) {
            ++counts[digit_of(from[i])];
        }
    });
    std::uint32_t next = 0;
    for (std::size_t digit = 0; digit < kDigits; ++digit) {
        for (Counts& counts : offsets) {
            next += std::exchange(counts[digit], next);
        }
    }
    executor.for_each(from.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Counts& next_of = offsets[begin / kGrain];
        for (std::size_t i = begin; i < end; ++i) {
            to[next_of[digit_of(from[i])]++] = from[i];
        }
    });
}

}  // namespace

LargeArray<MortonPrimitive> sorted_by_morton_code(std::span<const Aabb> boxes, Executor& executor) {
    const Grid grid = grid_of(boxes, executor);
    LargeArray<MortonPrimitive> primitives(boxes.size());
    executor.for_each(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            primitives[i] = {expand_bits(grid.cell(boxes[i], 0)) << 2U |
                                 expand_bits(grid.cell(boxes[i], 1)) << 1U |
                                 expand_bits(grid.cell(boxes[i], 2)),
                             static_cast<std::uint32_t>(i)};
        }
    });
    LargeArray<MortonPrimitive> other(boxes.size());
    for (unsigned shift = 0; shift < kCodeBits; shift += kDigitBits) {
        sort_by_digit(primitives, other, shift, executor);
        primitives.swap(other);
    }
    return primitives;
}

std::uint32_t find_morton_split(std::span<const MortonPrimitive> primitives,
                                std::uint32_t begin,
                                std::uint32_t end) noexcept {
    const std::uint64_t differing = primitives[begin].code ^ primitives[end - 1].code;
    if (differing == 0) {
        return begin + (end - begin) / 2;
    }
    const std::uint64_t bit = std::bit_floor(differing);
    const auto range = primitives.subspan(begin, end - begin);
    const auto first = std::partition_point(
        range.begin(), range.end(), [&](const MortonPrimitive& p) { return (p.code & bit) == 0; });
    return begin + static_cast<std::uint32_t>(first - range.begin());
}

}  // namespace earshot::bvh
