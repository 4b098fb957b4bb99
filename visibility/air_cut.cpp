// SPDX-License-Identifier: MIT
#include "earshot/visibility/air_cut.h"

#include "earshot/visibility/internal/side_nodes.h"
#include "earshot/visibility/internal/visibility_graph.h"
#include "earshot/visibility/min_cut.h"

#include <glm/common.hpp>

#include <chrono>

namespace earshot::visibility {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point& start) {
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start).count();
    start = now;
    return seconds;
}

/// Counts the links through an opening between air and what is no air. What leaves the scene
/// through the hole of a surface leaks even if the scene is open elsewhere.
void measure(const std::vector<FreeLink>& links,
             const Opening& opening,
             const std::vector<bool>& is_air,
             std::uint32_t beyond,
             OpeningFlow& flow) {
    for (const FreeLink& link : links) {
        const bool escapes = link.from == beyond || link.to == beyond;
        const bool is_leak = is_air[link.from] != is_air[link.to] ||
                             (!opening.is_strip && escapes && is_air[link.from] && is_air[link.to]);
        if (!is_leak) {
            continue;
        }
        flow.lower = flow.leaking == 0 ? link.place : glm::min(flow.lower, link.place);
        flow.upper = flow.leaking == 0 ? link.place : glm::max(flow.upper, link.place);
        ++flow.leaking;
        flow.escaping += escapes ? 1 : 0;
    }
}

SideLabel label_of(const SideNodes& nodes, const std::vector<bool>& is_air, SideId side) {
    std::size_t air = 0;
    std::size_t all = 0;
    nodes.for_each_node(side, [&](std::uint32_t node) {
        air += is_air[node] ? 1 : 0;
        ++all;
    });
    return air == 0 ? SideLabel::solid : air == all ? SideLabel::air : SideLabel::mixed;
}

}  // namespace

AirCut cut_air(const bvh::MeshBvh& bvh,
               std::span<const geometry::Vec3> points,
               std::span<const Opening> openings,
               const AirCutOptions& options,
               Executor& executor) {
    AirCut result;
    auto start = Clock::now();
    const SideNodes nodes(bvh, options, executor);
    result.cluster_seconds = seconds_since(start);

    VisibilityGraph graph(bvh, nodes, options, executor);
    graph.sample_nodes();
    if (points.empty()) {
        graph.add_outside();
    } else {
        graph.add_points(points);
    }
    std::vector<std::vector<FreeLink>> links(openings.size());
    result.openings.resize(openings.size());
    for (std::size_t i = 0; i < openings.size(); ++i) {
        links[i] = graph.add_opening(openings[i], i, result.openings[i]);
        if (options.progress != nullptr) {
            options.progress->report("openings", i + 1, openings.size());
        }
    }
    result.sampling_seconds = seconds_since(start);

    const std::vector<FlowEdge> edges = graph.flow_edges();
    const MinCut cut = find_min_cut(graph.size(), edges, graph.air(), graph.solid());
    result.cut_seconds = seconds_since(start);

    const std::vector<bool>& is_air = cut.is_source_side;
    result.flow = cut.flow;
    result.is_open = is_air[graph.beyond()];
    result.clusters = nodes.cluster_count();
    result.sampled_triangles = nodes.sampled_triangles();
    result.nodes = nodes.size();
    result.edges = edges.size();
    result.rays = graph.rays();
    for (const FlowEdge& edge : edges) {
        const bool is_tie = edge.a >= graph.air() || edge.b >= graph.air();
        result.leak_area += !is_tie && is_air[edge.a] != is_air[edge.b] ? edge.forward : 0.0;
    }
    for (std::size_t i = 0; i < openings.size(); ++i) {
        measure(links[i], openings[i], is_air, graph.beyond(), result.openings[i]);
    }
    result.label_of_side.resize(2 * bvh.mesh().triangles.size());
    for (SideId side = 0; side < result.label_of_side.size(); ++side) {
        result.label_of_side[side] = label_of(nodes, is_air, side);
    }
    return result;
}

}  // namespace earshot::visibility
