// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/visibility/internal/cell_leaf.h"
#include "earshot/visibility/view_cell_partition.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// The data common to all leaves while view cells are being built.
struct CellBuildContext {
    ViewRegion region{};
    std::vector<VisibilitySample> samples{};
    std::vector<double> costs{};    ///< per object
    std::vector<Viewer> viewers{};  ///< empty: uniform density
    double slack = 0.0;             ///< metres, see plane_slack()
};

/// A candidate plane of a leaf, and what splitting by it saves of the average cost.
struct SplitCandidate {
    CellNode plane{};
    double saving = 0.0;
};

/// The best plane of each leaf. Empty where no plane leaves a substantial part on both sides.
std::vector<std::optional<SplitCandidate>> best_split_planes(
    const CellBuildContext& build,
    const CellOptions& options,
    std::span<const CellLeaf* const> leaves,
    Executor& executor);

/// The spatial median: the plane through the middle of the longest side of a leaf's box.
CellNode spatial_median_plane(const CellLeaf& leaf);

}  // namespace earshot::visibility
