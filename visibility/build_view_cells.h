// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/visibility/free_segments.h"
#include "earshot/visibility/view_cell_partition.h"

#include <span>

namespace earshot::visibility {

/// Divides a region into view cells so that the average render cost, the sum over the cells of
/// fraction of viewers times cost of the cell's PVS, falls as fast as possible: the next split is
/// always that of the leaf and plane that saves most (GameTools 2007). The PVS of a cell holds the
/// objects at the ends of the segments that pass it. Candidate planes go through ends of segments,
/// clipped to the leaf, perpendicular to an axis, and through triangles. The result does not depend
/// on the executor. Throws Error if the region has no volume or is not finite, if no viewers are in
/// it, or if an option is out of range. Precondition: the segments' triangles are in objects.
BuiltCells build_view_cells(const ViewRegion& region,
                            std::span<const FreeSegment> segments,
                            const Objects& objects,
                            const CellOptions& options = {},
                            Executor& executor = Executor::serial());

}  // namespace earshot::visibility
