// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/objects.h"
#include "earshot/visibility/view_cells.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::visibility {

/// Two groups of leaves become one. Groups 0, 1, ... are the leaves, and merge k makes group
/// leaves + k.
struct CellMerge {
    std::uint32_t first = 0, second = 0;  ///< first < second
    double cost = 0.0;                    ///< average render cost of the partition after it
    std::uint64_t entries = 0;            ///< objects in the group's set
    friend bool operator==(const CellMerge&, const CellMerge&) = default;
};

/// The merge history of a partition (GameTools 2007): the steps by which its leaves become one
/// cell, each step the one that costs least. Any partition in between can be extracted without
/// further work: as many cells as wanted, or as few as memory or cost allow.
class MergeHistory {
public:
    /// From steps made elsewhere; `leaf_entries` holds the size of every leaf's set. Throws Error
    /// if the steps do not make one group out of all leaves, if costs fall, or if a group's set is
    /// smaller than one of its parts' or larger than both together.
    MergeHistory(double leaf_cost,
                 std::vector<std::uint64_t> leaf_entries,
                 std::vector<CellMerge> merges);

    std::size_t leaves() const noexcept { return leaf_entries_.size(); }
    double leaf_cost() const noexcept { return leaf_cost_; }  ///< average, of the unmerged leaves
    std::span<const std::uint64_t> leaf_entries() const noexcept { return leaf_entries_; }
    std::span<const CellMerge> merges() const noexcept { return merges_; }

    /// The same steps with the sizes of other sets, the final instead of the sampled ones, say.
    /// Throws Error if there is not one set per leaf. Sets are ascending.
    MergeHistory with_entries_of(std::span<const std::vector<ObjectId>> sets) const;

    // Each of the next two returns a number of cells.

    /// The fewest cells whose average cost is at most `ratio` times the leaves'. Throws Error if
    /// ratio is below 1.
    std::size_t cells_by_cost(double ratio) const;
    /// The most cells whose sets fit: bytes per entry times entries and bytes per cell times cells.
    /// Throws Error if one cell does not.
    struct Memory {
        std::uint64_t bytes = 0;
        std::uint64_t bytes_per_entry = sizeof(ObjectId);
        std::uint64_t bytes_per_cell = 32;
    };
    std::size_t cells_by_memory(const Memory& memory) const;

    /// The average cost and the number of entries of a partition into so many cells. Precondition:
    /// 1 <= cells <= leaves().
    double cost_of(std::size_t cells) const noexcept;
    std::uint64_t entries_of(std::size_t cells) const noexcept;

    /// Each leaf's cell in a partition into so many cells, or all leaves if there are fewer: for
    /// ViewCells::merged(). Cells are numbered by their lowest leaf. Precondition: cells > 0.
    std::vector<CellId> extract(std::size_t cells) const;

    friend bool operator==(const MergeHistory&, const MergeHistory&) = default;

private:
    std::uint64_t entries_in(std::uint32_t group) const noexcept;
    /// The number of entries that a merge saves.
    std::uint64_t entries_saved(std::size_t merge) const noexcept;

    double leaf_cost_ = 0.0;
    std::vector<std::uint64_t> leaf_entries_;
    std::vector<CellMerge> merges_;
};

}  // namespace earshot::visibility
