// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/facets.h"
#include "earshot/geometry/internal/border_lines.h"
#include "earshot/geometry/wedges.h"

#include <span>
#include <vector>

namespace earshot::geometry {

/// Adds the wedges on a line, along the line, then by angle. `nearby`: facets, ascending, among
/// them all whose boxes touch the line's grown by `tolerance` (metres).
void find_line_wedges(const Facets& facets,
                      const WedgeOptions& options,
                      const BorderLine& line,
                      std::span<const FacetId> nearby,
                      double tolerance,
                      std::vector<Wedge>& wedges);

}  // namespace earshot::geometry
