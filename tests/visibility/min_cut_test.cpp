// SPDX-License-Identifier: MIT
#include "earshot/visibility/min_cut.h"

#include "earshot/base/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>

namespace earshot::visibility {
namespace {

/// The capacity of the cheapest way to part node 0 from the last one, over all partitions.
double cheapest_partition(std::uint32_t nodes, const std::vector<FlowEdge>& edges) {
    double best = std::numeric_limits<double>::infinity();
    for (std::uint32_t set = 0; set < 1U << nodes; ++set) {
        const auto has = [set](std::uint32_t node) { return (set >> node & 1U) != 0; };
        if (!has(0) || has(nodes - 1)) {
            continue;
        }
        double sum = 0.0;
        for (const FlowEdge& edge : edges) {
            sum += has(edge.a) && !has(edge.b) ? edge.forward : 0.0;
            sum += has(edge.b) && !has(edge.a) ? edge.backward : 0.0;
        }
        best = std::min(best, sum);
    }
    return best;
}

TEST(MinCutTest, IsThatOfBruteForceOnRandomGraphs) {
    constexpr std::uint32_t kNodes = 12;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
        std::vector<FlowEdge> edges;
        for (std::uint64_t i = 0; i < 30; ++i) {
            const auto a = static_cast<std::uint32_t>(random_bits(seed, 0, i) % kNodes);
            const auto b = static_cast<std::uint32_t>(random_bits(seed, 1, i) % kNodes);
            if (a != b) {
                edges.push_back({a, b, random(seed, 2, i), i % 3 == 0 ? 0.0 : random(seed, 3, i)});
            }
        }
        const MinCut cut = find_min_cut(kNodes, edges, 0, kNodes - 1);
        EXPECT_TRUE(cut.is_source_side[0]);
        EXPECT_FALSE(cut.is_source_side[kNodes - 1]);
        const double want = cheapest_partition(kNodes, edges);
        EXPECT_NEAR(cut.flow, want, 1e-9) << seed;
        double across = 0.0;
        for (const FlowEdge& edge : edges) {
            const bool from_a = cut.is_source_side[edge.a];
            across += from_a && !cut.is_source_side[edge.b] ? edge.forward : 0.0;
            across += !from_a && cut.is_source_side[edge.b] ? edge.backward : 0.0;
        }
        EXPECT_NEAR(across, want, 1e-9) << seed;
    }
}

TEST(MinCutTest, NodesWithoutFlowAreOnTheSinksSide) {
    const MinCut cut = find_min_cut(4, std::vector<FlowEdge>{{0, 1, 2.0, 2.0}}, 0, 3);
    EXPECT_TRUE(cut.is_source_side[1]);
    EXPECT_FALSE(cut.is_source_side[2]);
    EXPECT_EQ(cut.flow, 0.0);
    EXPECT_FALSE(find_min_cut(2, {}, 0, 1).is_source_side[1]);
}

}  // namespace
}  // namespace earshot::visibility
