// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/mesh.h"
#include "earshot/visibility/merge_history.h"
#include "earshot/visibility/missed_share.h"
#include "earshot/visibility/objects.h"
#include "earshot/visibility/view_cells.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::visibility {

/// The scene and the sampling that visible sets come from.
struct SetsProvenance {
    std::string scene{};            ///< name of the scene
    double time = 0.0;              ///< instant of the scene's animation, seconds
    std::uint64_t mesh_digest = 0;  ///< mesh_digest() of the mesh at that instant
    std::uint64_t seed = 0;
    std::uint64_t rays = 0;
    std::optional<MissedShare> validation{};  ///< by validate_pvs(); of merged sets, before merging
    friend bool operator==(const SetsProvenance&, const SetsProvenance&) = default;
};

/// A hash of positions and triangles: tells meshes apart, and the poses of one mesh.
std::uint64_t mesh_digest(const geometry::MeshView& mesh) noexcept;

/// The potentially visible set (PVS) of each view cell of a region: from a viewpoint to its cell to
/// its set. Sampled sets are subsets of the true ones (aggressive), and hold for one pose of the
/// mesh.
class VisibleSets {
public:
    /// `sets` holds one per cell. A history has the cells as its leaves. Throws Error unless they
    /// are ascending sets of the objects, one per cell, and the history is of as many.
    VisibleSets(ViewCells cells,
                Objects objects,
                std::vector<std::vector<ObjectId>> sets,
                SetsProvenance provenance,
                std::optional<MergeHistory> history = std::nullopt);

    const ViewCells& cells() const noexcept { return cells_; }
    const Objects& objects() const noexcept { return objects_; }
    std::span<const std::vector<ObjectId>> sets() const noexcept { return sets_; }
    const SetsProvenance& provenance() const noexcept { return provenance_; }
    const std::optional<MergeHistory>& history() const noexcept { return history_; }
    std::uint64_t entries() const noexcept;  ///< of all sets together

    // Precondition of the next two: `cell` is below cells().size().

    /// Whether a triangle's object is in the set of a cell.
    bool contains(CellId cell, geometry::TriangleId triangle) const noexcept;
    /// The triangles of the objects in the set of a cell, ascending.
    std::vector<geometry::TriangleId> triangles_visible_from(CellId cell) const;

    /// Sets of fewer cells, merged as the history says, without a history. Throws Error if there is
    /// no history.
    /// Precondition: cells > 0.
    VisibleSets merged(std::size_t cells) const;

    friend bool operator==(const VisibleSets&, const VisibleSets&) = default;

private:
    ViewCells cells_;
    Objects objects_;
    std::vector<std::vector<ObjectId>> sets_;
    SetsProvenance provenance_;
    std::optional<MergeHistory> history_;
};

}  // namespace earshot::visibility
