// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/visibility/free_segments.h"
#include "earshot/visibility/objects.h"
#include "earshot/visibility/render_cost.h"
#include "earshot/visibility/view_cells.h"

#include <functional>
#include <span>
#include <vector>

namespace earshot::visibility {

enum class CellRule {
    cost,    ///< split where the average render cost falls most
    middle,  ///< split the largest leaf in the middle of its longest side: what cost has to beat
};

struct CellOptions {
    CellRule rule = CellRule::cost;
    std::size_t most_cells = 500;  ///< at least 1
    /// A split that saves a smaller part of the average cost is poor, and of a leaf that as many
    /// poor splits in a row led to no further one is tried. For CellRule::cost.
    double least_saving = 1e-6;
    int most_poor_splits = 3;
    /// Leaves that fewer segments pass are not divided: what they miss may be seen nevertheless.
    std::size_t least_segments = 32;
    RenderCost cost{};
    /// Its triangles' planes are tried too, up to a number of them per leaf, chosen at random from
    /// the seed. Without a mesh all planes are perpendicular to an axis.
    geometry::MeshView mesh{};
    std::size_t most_triangle_planes = 16;
    std::uint64_t seed = 1;
    /// How often viewers are at a point, in any unit, never negative; empty: everywhere alike. It
    /// is asked at `density_points` points of the region, on the calling thread.
    std::function<double(const geometry::Vec3&)> density{};
    std::size_t density_points = 65536;
    Progress* progress = nullptr;
};

/// A split of a leaf. Its back keeps the leaf's number, its front gets the next free one.
struct CellSplit {
    LeafId leaf = 0;
    double saving = 0.0;  ///< of the average cost, as expected when the leaf was made
    double cost = 0.0;    ///< the average cost after this split
    friend bool operator==(const CellSplit&, const CellSplit&) = default;
};

struct BuiltCells {
    ViewCells cells;                            ///< one cell per leaf
    std::vector<std::vector<ObjectId>> sets{};  ///< per leaf: what the segments saw, ascending
    std::vector<double> shares{};               ///< per leaf: of the viewers; they sum to 1
    double region_cost = 0.0;                   ///< the average cost of the undivided region
    std::vector<CellSplit> splits{};            ///< node k of the tree is split k
};

/// Divides a region so that the average render cost of what is seen from a cell, sum over the cells
/// of share of viewers times cost of the set, falls as fast as possible: always the split of the
/// leaf and plane that saves most (GameTools 2007). A cell's set is what the segments that pass it
/// end at. Planes go through ends of segments, clipped to the leaf, perpendicular to an axis, and
/// through triangles. The result does not depend on the executor. Throws Error if the region has no
/// volume or is not finite, if no viewers are in it, or if an option is out of range. Precondition:
/// the segments' triangles are in objects.
BuiltCells build_view_cells(const Region& region,
                            std::span<const FreeSegment> segments,
                            const Objects& objects,
                            const CellOptions& options = {},
                            Executor& executor = Executor::serial());

}  // namespace earshot::visibility
