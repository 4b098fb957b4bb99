// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/visibility/merge_history.h"

#include <span>
#include <vector>

namespace earshot::visibility {

/// Merges adjacent leaves, always the two whose merging adds least to the average render cost, of
/// equals the lowest numbers, until one is left; parts of the region that are not adjacent are
/// merged last. `sets` holds one ascending set per leaf, sampled or final; `costs` one number per
/// object; `viewer_fractions` the fraction of the viewers in each leaf; if empty, by volume, or the
/// same for all leaves of a flat region. The result does not depend on the executor. Throws Error
/// if there is not one set, or fraction, per leaf, or an object without cost.
MergeHistory merge_cells(const ViewCells& cells,
                         std::span<const std::vector<ObjectId>> sets,
                         std::span<const double> costs,
                         std::span<const double> viewer_fractions = {},
                         Executor& executor = Executor::serial());

/// The sets of merged cells: unions over their leaves. Precondition: a cell per set.
std::vector<std::vector<ObjectId>> merged_sets(std::span<const std::vector<ObjectId>> sets,
                                               std::span<const CellId> cell_of_leaf);

}  // namespace earshot::visibility
