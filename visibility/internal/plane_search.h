// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/visibility/build_view_cells.h"
#include "earshot/visibility/internal/cell_leaf.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// What all leaves have in common while view cells are being built.
struct CellBuild {
    ViewRegion region{};
    std::vector<Sight> sights{};
    std::vector<double> costs{};    ///< per object
    std::vector<Viewer> viewers{};  ///< none: everywhere alike
    double slack = 0.0;             ///< metres, see plane_slack()
};

/// A plane to divide a leaf by, and what that saves of the average cost.
struct Proposal {
    CellNode plane{};
    double saving = 0.0;
};

/// The best plane of each of some leaves. Empty where none leaves a substantial part on both sides.
std::vector<std::optional<Proposal>> best_planes(const CellBuild& build,
                                                 const CellOptions& options,
                                                 std::span<const CellLeaf* const> leaves,
                                                 Executor& executor);

/// The middle of the longest side of a leaf's box.
CellNode middle_plane(const CellLeaf& leaf);

}  // namespace earshot::visibility
