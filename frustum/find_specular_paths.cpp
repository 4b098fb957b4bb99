// SPDX-License-Identifier: MIT
#include "earshot/frustum/find_specular_paths.h"

#include "earshot/base/assert.h"
#include "earshot/frustum/path_finder.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace earshot::frustum {

using geometry::Vec3;

TraceResult find_specular_paths(const SceneView& scene,
                                const Vec3& source,
                                std::span<const Vec3> listeners,
                                const TraceOptions& options,
                                Executor& executor) {
    double max_radius = std::max(glm::length(source), std::numeric_limits<double>::min());
    for (const Vec3& listener : listeners) {
        max_radius = std::max(max_radius, glm::length(listener));
    }
    const PathFinder finder(scene,
                            {.trace = options,
                             .forward_only = prefer_forward(listeners.size(), options.max_order),
                             .max_radius = max_radius,
                             .listener_count = listeners.size()},
                            executor);
    const ListenerBeamTree to = finder.trace_listeners(listeners, executor);
    TraceResult result = finder.find(source, to, {}, executor);
    result.statistics.frusta += to.frusta();
    return result;
}

TraceResult find_direct_paths(const bvh::MeshBvh& bvh,
                              const PlacedPairs& pairs,
                              const TraceOptions& options) {
    validate(options);
    EARSHOT_ASSERT(options.max_order == 0 && !pairs.is_moved);
    TraceResult result;
    for (const PlacedListeners& group : pairs.groups) {
        for (std::size_t i = 0; i < group.positions.size(); ++i) {
            const Vec3& listener = group.positions[i];
            const double length = glm::distance(group.source, listener);
            if (!(length <= options.max_length) || options.min_pressure * length > 1.0) {
                continue;
            }
            ++result.statistics.candidates;
            if (!bvh.occluded({group.source, listener})) {
                result.paths.push_back({.listener = group.numbers[i],
                                        .triangles = {},
                                        .points = {group.source, listener},
                                        .length = length});
            }
        }
    }
    result.statistics.paths = result.paths.size();
    return result;
}

}  // namespace earshot::frustum
