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

constexpr std::size_t kGrain = 16384;
constexpr unsigned kCodeBits = 32;

/// Twice the centroid; infinite and undefined ones go to the ends.
float doubled_centroid(const Aabb& box, std::size_t axis) noexcept {
    constexpr float kLargest = std::numeric_limits<float>::max();
    const float c = box.lower[axis] + box.upper[axis];
    return c > -kLargest ? std::min(c, kLargest) : -kLargest;
}

/// Bounds of centroids.
struct CentroidBounds {
    std::array<float, 3> lower, upper;

    CentroidBounds() {
        lower.fill(std::numeric_limits<float>::max());
        upper.fill(std::numeric_limits<float>::lowest());
    }
    void include(const Aabb& box) noexcept {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float c = doubled_centroid(box, axis);
            lower[axis] = std::min(lower[axis], c);
            upper[axis] = std::max(upper[axis], c);
        }
    }
    void include(const CentroidBounds& other) noexcept {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], other.lower[axis]);
            upper[axis] = std::max(upper[axis], other.upper[axis]);
        }
    }
};

/// The map from centroids to codes.
class CodeGrid {
public:
    explicit CodeGrid(const CentroidBounds& bounds) {
        std::array<double, 3> side{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lower_[axis] = static_cast<double>(bounds.lower[axis]);
            side[axis] = static_cast<double>(bounds.upper[axis]) - lower_[axis];
        }
        const std::array<double, 3> extent = side;
        for (unsigned bit = kCodeBits; bit-- > 0;) {
            std::size_t longest = 0;
            for (std::size_t axis = 1; axis < 3; ++axis) {
                longest = side[axis] > side[longest] ? axis : longest;
            }
            if (!(side[longest] > 0.0)) {
                break;
            }
            places_[longest][bits_[longest]++] = bit;
            // An axis that has no more bits is not halved any more.
            side[longest] = bits_[longest] == kMaxAxisBits ? 0.0 : 0.5 * side[longest];
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // A little less than the cells, so that the farthest centroid lies in the last one.
            const double cells = std::ldexp(1.0 - 0x1p-20, static_cast<int>(bits_[axis]));
            const double scale = cells / extent[axis];
            scale_[axis] = extent[axis] > 0.0 && std::isfinite(scale) ? scale : 0.0;
            fill_table(axis);
        }
    }

    std::uint32_t code(const Aabb& box) const noexcept {
        std::uint32_t code = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double position =
                (static_cast<double>(doubled_centroid(box, axis)) - lower_[axis]) * scale_[axis];
            const auto cell = static_cast<std::uint32_t>(static_cast<std::int32_t>(position));
            code |= table_[axis][0][cell & 255U] | table_[axis][1][cell >> 8U];
        }
        return code;
    }

private:
    static constexpr unsigned kMaxAxisBits = 16;

    /// The bits of a cell's number, lower and upper byte, at their places in the code.
    void fill_table(std::size_t axis) {
        for (unsigned byte = 0; byte < 2; ++byte) {
            auto& table = table_[axis][byte];
            table.fill(0);
            for (std::uint32_t value = 1; value < 256; ++value) {
                const auto lowest = static_cast<unsigned>(std::countr_zero(value));
                const unsigned bit = 8 * byte + lowest;
                const std::uint32_t place =
                    bit < bits_[axis] ? 1U << places_[axis][bits_[axis] - 1 - bit] : 0U;
                table[value] = table[value & (value - 1)] | place;
            }
        }
    }

    std::array<double, 3> lower_{}, scale_{};
    std::array<unsigned, 3> bits_{};
    std::array<std::array<unsigned, kMaxAxisBits>, 3> places_{};  // from the highest on
    std::array<std::array<std::array<std::uint32_t, 256>, 2>, 3> table_;
};

constexpr unsigned kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

using DigitCounts = std::array<std::uint32_t, kDigits>;

/// Turns the counts of each chunk into its offsets among the numbers with the same digit, and
/// returns where the numbers with each digit begin.
DigitCounts to_offsets(std::span<DigitCounts> counts, Executor& executor) {
    constexpr std::size_t kDigitsPerTask = 64;
    DigitCounts firsts{};
    executor.for_each(kDigits, kDigitsPerTask, [&](std::size_t begin, std::size_t end) {
        for (DigitCounts& of_chunk : counts) {
            for (std::size_t digit = begin; digit < end; ++digit) {
                firsts[digit] += std::exchange(of_chunk[digit], firsts[digit]);
            }
        }
    });
    std::uint32_t next = 0;
    for (std::uint32_t& first : firsts) {
        next += std::exchange(first, next);
    }
    return firsts;
}

/// One stable pass of a radix sort. Every chunk has its own counts and scatters to its own offsets,
/// so the order does not depend on the executor.
void sort_by_digit(std::span<const MortonPrimitive> from,
                   std::span<MortonPrimitive> to,
                   unsigned shift,
                   Executor& executor) {
    const std::size_t grain = executor.threads() == 1 ? from.size() : kGrain;
    std::vector<DigitCounts> chunks(chunk_count(from.size(), grain));
    const auto digit_of = [&](const MortonPrimitive& primitive) {
        return primitive.code >> shift & (kDigits - 1);
    };
    executor.for_each(from.size(), grain, [&](std::size_t begin, std::size_t end) {
        DigitCounts& counts = chunks[begin / grain];
        counts.fill(0);
        for (std::size_t i = begin; i < end; ++i) {
            ++counts[digit_of(from[i])];
        }
    });
    const DigitCounts firsts = to_offsets(chunks, executor);
    executor.for_each(from.size(), grain, [&](std::size_t begin, std::size_t end) {
        DigitCounts& next_of = chunks[begin / grain];
        for (std::size_t digit = 0; digit < kDigits; ++digit) {
            next_of[digit] += firsts[digit];
        }
        for (std::size_t i = begin; i < end; ++i) {
            to[next_of[digit_of(from[i])]++] = from[i];
        }
    });
}

/// Precondition: sorted by index.
void sort_by_code(std::span<MortonPrimitive> primitives, Executor& executor) {
    constexpr std::size_t kFewPrimitives = 1024;
    if (primitives.size() <= kFewPrimitives) {
        std::sort(primitives.begin(),
                  primitives.end(),
                  [](const MortonPrimitive& a, const MortonPrimitive& b) {
                      return a.code != b.code ? a.code < b.code : a.index < b.index;
                  });
        return;
    }
    LargeArray<MortonPrimitive> memory(primitives.size());
    std::span<MortonPrimitive> from = primitives, to = memory;
    for (unsigned shift = 0; shift < kCodeBits; shift += kDigitBits) {
        sort_by_digit(from, to, shift, executor);
        std::swap(from, to);
    }
    if (from.data() != primitives.data()) {
        std::copy(from.begin(), from.end(), primitives.begin());
    }
}

/// Sets the codes of primitives on a grid over their own centroids and sorts by these; false if
/// all centroids coincide. Precondition: sorted by index.
bool code_and_sort(std::span<const Aabb> boxes,
                   std::span<MortonPrimitive> primitives,
                   Executor& executor) {
    std::vector<CentroidBounds> chunks(chunk_count(primitives.size(), kGrain));
    executor.for_each(primitives.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        CentroidBounds bounds;
        for (std::size_t i = begin; i < end; ++i) {
            bounds.include(boxes[primitives[i].index]);
        }
        chunks[begin / kGrain] = bounds;
    });
    CentroidBounds all;
    for (const CentroidBounds& chunk : chunks) {
        all.include(chunk);
    }
    if (all.lower == all.upper) {
        return false;
    }
    const CodeGrid grid(all);
    executor.for_each(primitives.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            primitives[i].code = grid.code(boxes[primitives[i].index]);
        }
    });
    sort_by_code(primitives, executor);
    return true;
}

}  // namespace

LargeArray<MortonPrimitive> sorted_by_morton_code(std::span<const Aabb> boxes, Executor& executor) {
    LargeArray<MortonPrimitive> primitives(boxes.size());
    executor.for_each(primitives.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            primitives[i] = {0, static_cast<std::uint32_t>(i)};
        }
    });
    code_and_sort(boxes, primitives, executor);
    return primitives;
}

std::uint32_t split_morton_range(std::span<const Aabb> boxes,
                                 std::span<MortonPrimitive> primitives,
                                 MortonRange& range,
                                 Executor& executor) {
    const std::span<MortonPrimitive> run = primitives.subspan(range.begin, range.size());
    // Fewer primitives in so small a cell are not worth it.
    constexpr std::size_t kMinPrimitives = 4096;
    if (run.front().code == run.back().code && run.size() >= kMinPrimitives &&
        !range.is_one_point) {
        range.is_one_point = !code_and_sort(boxes, run, executor);
    }
    return range.begin + static_cast<std::uint32_t>(curve_split(run));
}

std::size_t curve_split(std::span<const MortonPrimitive> run) noexcept {
    const std::uint32_t differing = run.front().code ^ run.back().code;
    if (differing == 0) {
        return run.size() / 2;
    }
    const std::uint32_t bit = std::bit_floor(differing);
    const auto first = std::partition_point(
        run.begin(), run.end(), [&](const MortonPrimitive& p) { return (p.code & bit) == 0; });
    return static_cast<std::size_t>(first - run.begin());
}

}  // namespace earshot::bvh
