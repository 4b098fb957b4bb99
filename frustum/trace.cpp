// SPDX-License-Identifier: MIT
#include "earshot/frustum/trace.h"

#include "earshot/frustum/path_finder.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace earshot::frustum {

using geometry::Vec3;

TraceResult find_specular_paths(const Surroundings& surroundings,
                                const Vec3& source,
                                std::span<const Vec3> listeners,
                                const TraceOptions& options,
                                Executor& executor) {
    double reach = std::max(glm::length(source), std::numeric_limits<double>::min());
    for (const Vec3& listener : listeners) {
        reach = std::max(reach, glm::length(listener));
    }
    const PathFinder finder(surroundings,
                            {.trace = options,
                             .all_the_way = are_many(listeners.size(), options.max_order),
                             .reach = reach});
    const ListenerTrace to = finder.trace_listeners(listeners, executor);
    TraceResult result = finder.find(source, to, executor);
    result.statistics.frusta += to.frusta();
    return result;
}

}  // namespace earshot::frustum
