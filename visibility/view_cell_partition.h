// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/progress.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/exclusion_mask.h"
#include "earshot/visibility/objects.h"
#include "earshot/visibility/render_cost.h"
#include "earshot/visibility/view_cells.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace earshot::visibility {

/// How build_view_cells() chooses the next leaf and its plane.
enum class CellRule {
    cost,    ///< the split that lowers the average render cost most
    middle,  ///< the spatial median of the largest leaf's longest side, as a baseline
};

/// Parameters of build_view_cells().
struct CellOptions {
    CellRule rule = CellRule::cost;
    std::size_t max_cells = 500;  ///< at least 1
    /// A split that saves a smaller fraction of the average cost is poor, and a leaf below
    /// `max_poor_splits` poor splits in a row is not split. For CellRule::cost.
    double min_saving = 1e-6;
    int max_poor_splits = 3;
    /// Leaves that fewer segments pass are not split: the sample says too little about them.
    std::size_t min_segments = 32;
    RenderCost cost{};
    /// The planes of its triangles are candidates too, up to `max_triangle_planes` per leaf, chosen
    /// at random from the seed. Without a mesh all planes are perpendicular to an axis.
    geometry::MeshView mesh{};
    std::size_t max_triangle_planes = 16;
    ExclusionMask excluded{};  ///< triangles whose planes are no candidates
    std::uint64_t seed = 1;
    /// Density of viewers at a point, in any unit, never negative; empty: uniform. It is evaluated
    /// at `density_points` points of the region, on the calling thread.
    std::function<double(const geometry::Vec3&)> density{};
    std::size_t density_points = 65536;
    Progress* progress = nullptr;
    Interrupt interrupt{};  ///< checked between splits; there are then fewer cells
};

/// A split of a leaf. The back half keeps the leaf's number, the front half gets the next free one.
struct CellSplit {
    LeafId leaf = 0;
    double saving = 0.0;  ///< of the average cost, as expected when the leaf was made
    double cost = 0.0;    ///< the average cost after this split
    friend bool operator==(const CellSplit&, const CellSplit&) = default;
};

/// View cells with the sampled sets that they were built by.
struct BuiltCells {
    ViewCells cells;                            ///< one cell per leaf
    std::vector<std::vector<ObjectId>> sets{};  ///< per leaf: the sampled PVS, ascending
    std::vector<double> viewer_fractions{};     ///< per leaf: of the viewers; they sum to 1
    double region_cost = 0.0;                   ///< the average cost of the undivided region
    std::vector<CellSplit> splits{};            ///< node k of the tree is split k
};

}  // namespace earshot::visibility
