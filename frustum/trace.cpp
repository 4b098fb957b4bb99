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
    // A listener's own frusta cost as much as a first reflection's and all behind it. From order 4
    // on there is much more to be saved by them.
    const std::size_t few = options.max_order > 3 ? 512 : 64;
    const PathFinder finder(
        surroundings, {.trace = options, .all_the_way = listeners.size() > few, .reach = reach});
    return finder.find(source, finder.trace_listeners(listeners, executor), executor);
}

}  // namespace earshot::frustum
