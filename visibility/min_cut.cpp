// SPDX-License-Identifier: MIT
#include "earshot/visibility/min_cut.h"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/property_map/property_map.hpp>
#include <cmath>

namespace earshot::visibility {
namespace {

using Capacity = std::int64_t;
constexpr double kSteps = 0x1p40;  // of the sum of all capacities

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
struct EdgeState {
    Capacity capacity = 0;
    Capacity residual = 0;
    Traits::edge_descriptor reverse{};
};
using Graph = boost::
    adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property, EdgeState>;

Graph graph_of(std::size_t node_count, std::span<const FlowEdge> edges, double scale) {
    Graph graph(node_count);
    for (const FlowEdge& edge : edges) {
        const auto forward = boost::add_edge(edge.a, edge.b, graph).first;
        const auto backward = boost::add_edge(edge.b, edge.a, graph).first;
        graph[forward].capacity = static_cast<Capacity>(std::llround(scale * edge.forward));
        graph[backward].capacity = static_cast<Capacity>(std::llround(scale * edge.backward));
        graph[forward].reverse = backward;
        graph[backward].reverse = forward;
    }
    return graph;
}

/// The nodes that the source still reaches: the smallest source side of all minimum cuts, whichever
/// maximum flow it was.
std::vector<bool> reached_in_residual(const Graph& graph, std::uint32_t source) {
    std::vector<bool> is_reached(boost::num_vertices(graph), false);
    std::vector<std::size_t> stack{source};
    is_reached[source] = true;
    while (!stack.empty()) {
        const std::size_t node = stack.back();
        stack.pop_back();
        const auto [begin, end] = boost::out_edges(node, graph);
        for (auto edge = begin; edge != end; ++edge) {
            const std::size_t next = boost::target(*edge, graph);
            if (graph[*edge].residual > 0 && !is_reached[next]) {
                is_reached[next] = true;
                stack.push_back(next);
            }
        }
    }
    return is_reached;
}

}  // namespace

MinCut find_min_cut(std::size_t node_count,
                    std::span<const FlowEdge> edges,
                    std::uint32_t source,
                    std::uint32_t sink) {
    double sum = 0.0;
    for (const FlowEdge& edge : edges) {
        sum += edge.forward + edge.backward;
    }
    const double scale = sum > 0.0 ? kSteps / sum : 0.0;
    Graph graph = graph_of(node_count, edges, scale);
    std::vector<boost::default_color_type> colours(node_count);
    std::vector<Capacity> distances(node_count);
    std::vector<Traits::edge_descriptor> predecessors(node_count);
    const auto index = boost::get(boost::vertex_index, graph);
    const Capacity flow = boost::boykov_kolmogorov_max_flow(
        graph,
        boost::get(&EdgeState::capacity, graph),
        boost::get(&EdgeState::residual, graph),
        boost::get(&EdgeState::reverse, graph),
        boost::make_iterator_property_map(predecessors.begin(), index),
        boost::make_iterator_property_map(colours.begin(), index),
        boost::make_iterator_property_map(distances.begin(), index),
        index,
        boost::vertex(source, graph),
        boost::vertex(sink, graph));
    return {.is_source_side = reached_in_residual(graph, source),
            .flow = scale > 0.0 ? static_cast<double>(flow) / scale : 0.0};
}

}  // namespace earshot::visibility
