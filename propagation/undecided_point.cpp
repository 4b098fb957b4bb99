// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/undecided_point.h"

#include <string>

namespace earshot::propagation {

Error undecided_point_error(const frustum::UndecidedPoint& point,
                            const Emitter& source,
                            const Emitter& listener,
                            geometry::TriangleId triangle) {
    const std::string of_source = "source " + source.name;
    const std::string of_listener = "listener " + listener.name;
    const std::string& name = point.is_source ? of_source : of_listener;
    const std::string& other = point.is_source ? of_listener : of_source;
    const std::string surface = "triangle " + std::to_string(triangle);
    if (point.problem == frustum::PlacementProblem::edge_of_free_sheet) {
        return Error(name,
                     "lies on the edge of a free sheet, " + surface +
                         ", so that its side of the sheet is not known",
                     "move it off the edge");
    }
    return Error(name,
                 "lies on " + surface + ", and " + other +
                     " lies in the plane of it, so that their side of it is not known",
                 "move one of them off the plane");
}

}  // namespace earshot::propagation
