// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/visibility/merge_history.h"
#include "earshot/visibility/objects.h"
#include "earshot/visibility/view_cells.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::visibility {

/// Of what and how sets were made.
struct SetsOrigin {
    std::string scene;              ///< its name
    double time = 0.0;              ///< the instant of its animation, seconds
    std::uint64_t mesh_digest = 0;  ///< mesh_digest() then
    std::uint64_t seed = 0;
    std::uint64_t rays = 0;
    double missed_share = 0.0;  ///< RegionView::missed_share or GlobalView::missed_share
    friend bool operator==(const SetsOrigin&, const SetsOrigin&) = default;
};

/// Tells meshes apart, and the poses of one.
std::uint64_t mesh_digest(const geometry::MeshView& mesh) noexcept;

/// What can be seen from each cell of a region: from a point to its cell to its set. Sets that were
/// sampled are subsets of what can be seen (aggressive), and hold for one pose of the mesh.
class VisibleSets {
public:
    /// `sets` holds one per cell. A history has the cells as its leaves. Throws Error unless they
    /// are ascending sets of the objects, one per cell, and the history is of as many.
    VisibleSets(ViewCells cells,
                Objects objects,
                std::vector<std::vector<ObjectId>> sets,
                SetsOrigin origin,
                std::optional<MergeHistory> history = std::nullopt);

    const ViewCells& cells() const noexcept { return cells_; }
    const Objects& objects() const noexcept { return objects_; }
    std::span<const std::vector<ObjectId>> sets() const noexcept { return sets_; }
    const SetsOrigin& origin() const noexcept { return origin_; }
    const std::optional<MergeHistory>& history() const noexcept { return history_; }
    std::uint64_t entries() const noexcept;  ///< of all sets together

    // Precondition of the next two: the cell is one.

    bool sees(CellId cell, geometry::TriangleId triangle) const noexcept;
    /// Ascending.
    std::vector<geometry::TriangleId> triangles_seen_from(CellId cell) const;

    /// Fewer cells, as the history has them, without a history. Throws Error if there is none.
    /// Precondition: cells > 0.
    VisibleSets merged(std::size_t cells) const;

    friend bool operator==(const VisibleSets&, const VisibleSets&) = default;

private:
    ViewCells cells_;
    Objects objects_;
    std::vector<std::vector<ObjectId>> sets_;
    SetsOrigin origin_;
    std::optional<MergeHistory> history_;
};

}  // namespace earshot::visibility
