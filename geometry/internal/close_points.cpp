// SPDX-License-Identifier: MIT
#include "earshot/geometry/internal/close_points.h"

#include "earshot/geometry/internal/first_index_table.h"

#include <glm/geometric.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

namespace earshot::geometry {
namespace {

constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();

/// Points hashed by the cells of a grid (Teschner et al. 2003). A point lies in every cell that it
/// is close to, so that two close points share a cell: that of the second.
class CellTable {
public:
    CellTable(std::span<const Vec3> points, double distance, std::vector<std::uint8_t>& marks)
        : points_(points),
          marks_(marks),
          squared_(distance * distance * kGrow),
          margin_(distance * kGrow),
          cells_per_metre_(1.0 / (kCellSize * distance)),
          slots_(std::bit_ceil(3 * points.size() + 1), kFree) {}

    void add(std::uint32_t index) {
        const Vec3& point = points_[index];
        std::array<std::array<std::int64_t, 2>, 3> range;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double position = point[static_cast<int>(axis)];
            range[axis] = {cell_of(position - margin_), cell_of(position + margin_)};
        }
        for (std::int64_t x = range[0][0]; x <= range[0][1]; ++x) {
            for (std::int64_t y = range[1][0]; y <= range[1][1]; ++y) {
                for (std::int64_t z = range[2][0]; z <= range[2][1]; ++z) {
                    add(index, x, y, z);
                }
            }
        }
    }

private:
    // Cells are large enough for most points to be in one only, and small enough to hold few.
    static constexpr double kCellSize = 32.0;
    // More than the roundings of differences of coordinates.
    static constexpr double kGrow = 1.0 + 0x1p-12;
    // Longer runs of slots are not searched to their end: what stands there counts as close.
    static constexpr std::size_t kMaxProbes = 64;

    std::int64_t cell_of(double position) const noexcept {
        return static_cast<std::int64_t>(std::floor(position * cells_per_metre_));
    }

    // What stands between the cell's first slot and a free one may be of the same cell.
    void add(std::uint32_t index, std::int64_t x, std::int64_t y, std::int64_t z) {
        std::uint64_t hash = mixed_hash(0, static_cast<std::uint64_t>(x));
        hash = mixed_hash(hash, static_cast<std::uint64_t>(y));
        hash = mixed_hash(hash, static_cast<std::uint64_t>(z));
        const std::size_t mask = slots_.size() - 1;
        const std::size_t first = hash & mask;
        std::size_t slot = first;
        for (std::size_t probe = 0; slots_[slot] != kFree; ++probe) {
            if (probe == kMaxProbes) {
                mark_run(index, first);
                return;
            }
            const Vec3 offset = points_[slots_[slot]] - points_[index];
            if (slots_[slot] != index && glm::dot(offset, offset) <= squared_) {
                marks_[index] = marks_[slots_[slot]] = 1;
            }
            slot = (slot + 1) & mask;
        }
        slots_[slot] = index;
    }

    void mark_run(std::uint32_t index, std::size_t first) {
        marks_[index] = 1;
        for (std::size_t probe = 0; probe <= kMaxProbes; ++probe) {
            marks_[slots_[(first + probe) & (slots_.size() - 1)]] = 1;
        }
    }

    std::span<const Vec3> points_;
    std::vector<std::uint8_t>& marks_;
    double squared_, margin_, cells_per_metre_;
    std::vector<std::uint32_t> slots_;
};

}  // namespace

std::vector<std::uint8_t> mark_close_points(std::span<const Vec3> points,
                                            std::span<const std::uint8_t> takes_part,
                                            double distance) {
    std::vector<std::uint8_t> marks(points.size(), 0);
    CellTable table(points, distance, marks);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (takes_part[i] != 0) {
            table.add(static_cast<std::uint32_t>(i));
        }
    }
    return marks;
}

}  // namespace earshot::geometry
