// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/region.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

using CellId = std::uint32_t;
using LeafId = std::uint32_t;

/// The plane that splits a node: points behind it, dot(normal, p) < offset, belong to `back`,
/// points on it to `front`.
struct CellNode {
    geometry::Vec3 normal{};
    double offset = 0.0;
    /// Another node's index, or kCellLeaf + LeafId.
    std::uint32_t back = 0;
    std::uint32_t front = 0;
    friend bool operator==(const CellNode&, const CellNode&) = default;
};

inline constexpr std::uint32_t kCellLeaf = 0x80000000U;

/// A region divided into convex leaves by a binary space partition (BSP), and view cells that each
/// consist of one leaf or of several. Point location and the cells along a segment are decided in
/// double precision by the planes alone.
class ViewCells {
public:
    // All constructors and grid() throw Error as validate(region).

    /// One cell: the region.
    explicit ViewCells(const ViewRegion& region);

    /// From a partition made elsewhere: the root first, parents before children. `volumes` holds
    /// one per leaf, cubic metres. One cell per leaf. Throws Error if it is no tree over all of the
    /// leaves, or deeper than 4096.
    ViewCells(const ViewRegion& region, std::vector<CellNode> nodes, std::vector<double> volumes);

    /// Equal boxes, numbered with x the fastest and z the slowest. Throws Error if there are none
    /// or more than kMaxLeaves.
    static ViewCells grid(const ViewRegion& region, const std::array<std::uint32_t, 3>& counts);

    static constexpr std::size_t kMaxLeaves = std::size_t{1} << 24U;

    /// The same leaves grouped into other cells. Throws Error unless there is a number per leaf and
    /// each from 0 to the largest of them occurs.
    ViewCells merged(std::vector<CellId> cell_of_leaf) const;

    const ViewRegion& region() const noexcept { return region_; }
    std::size_t size() const noexcept { return volumes_.size(); }
    std::size_t leaves() const noexcept { return leaf_volumes_.size(); }
    std::span<const CellNode> nodes() const noexcept { return nodes_; }
    std::span<const CellId> cell_of_leaf() const noexcept { return cell_of_leaf_; }
    std::span<const double> leaf_volumes() const noexcept { return leaf_volumes_; }
    /// The volume of each cell, cubic metres.
    std::span<const double> volumes() const noexcept { return volumes_; }

    /// Empty outside of the region.
    std::optional<LeafId> leaf_at(const geometry::Vec3& point) const noexcept;
    std::optional<CellId> cell_at(const geometry::Vec3& point) const noexcept;

    /// The cells that a segment pierces, ascending, each once, into `cells`.
    void pierced(const geometry::Segment& segment, std::vector<CellId>& cells) const;

    friend bool operator==(const ViewCells&, const ViewCells&) = default;

private:
    void add_pierced(std::uint32_t child,
                     const geometry::Segment& segment,
                     const geometry::Interval& part,
                     std::vector<CellId>& cells) const;
    void sum_volumes();

    ViewRegion region_;
    std::vector<CellNode> nodes_;
    std::vector<double> leaf_volumes_;
    std::vector<CellId> cell_of_leaf_;
    std::vector<double> volumes_;
};

}  // namespace earshot::visibility
