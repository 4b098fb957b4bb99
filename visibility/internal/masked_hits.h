// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/geometry/mesh.h"
#include "earshot/visibility/exclusion_mask.h"

#include <optional>
#include <span>

namespace earshot::visibility {

/// The closest hit of every ray as if the excluded triangles were absent: that of a tree over the
/// others, to the last bit. False if the interrupt ended the work; `hits` is then not valid.
/// Precondition: as many hits as rays; the tree was built over or refitted to this mesh.
bool closest_hits(const bvh::MeshBvh& bvh,
                  std::span<const geometry::Ray> rays,
                  const ExclusionMask& excluded,
                  std::span<std::optional<geometry::Hit>> hits,
                  Executor& executor,
                  const Interrupt& interrupt = {});

/// A mask that also excludes the triangles without area, which rays hit by rounding only.
ExclusionMask with_degenerate(ExclusionMask excluded, const geometry::MeshView& mesh);

}  // namespace earshot::visibility
