// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/visibility/air_cut.h"
#include "earshot/visibility/internal/side_nodes.h"
#include "earshot/visibility/min_cut.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::visibility {

/// A straight way that is free between two nodes; the place is where it passes an opening.
struct FreeLink {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    geometry::Vec3 place{0.0};
};

/// The visibility graph of a mesh, sampled by rays (Zhou et al. 2008, section 3.2). Its nodes are
/// those of SideNodes, then `beyond` (what lies beyond the scene), `air` and `solid`.
class VisibilityGraph {
public:
    VisibilityGraph(const bvh::MeshBvh& bvh,
                    const SideNodes& nodes,
                    const AirCutOptions& options,
                    Executor& executor);

    std::uint32_t beyond() const noexcept { return static_cast<std::uint32_t>(nodes_.size()); }
    std::uint32_t air() const noexcept { return beyond() + 1; }
    std::uint32_t solid() const noexcept { return beyond() + 2; }
    std::size_t size() const noexcept { return nodes_.size() + 3; }

    /// Casts the rays of all nodes.
    void sample_nodes();
    /// Ties the sides that the points see to the air, and their backs to the solid.
    void add_points(std::span<const geometry::Vec3> points);
    /// Makes what lies beyond the scene the air, as the paper has it.
    void add_outside();
    /// Casts rays through an opening, and adds what passes it to the weights unless it is a strip.
    std::vector<FreeLink> add_opening(const Opening& opening,
                                      std::uint64_t index,
                                      OpeningFlow& flow);

    /// All edges with their capacities.
    std::vector<FlowEdge> flow_edges() const;
    std::uint64_t rays() const noexcept { return rays_; }
    /// Weight between two nodes in square metres, of the rays of both; `beyond` may be the second.
    struct Weight {
        std::uint32_t a = 0, b = 0;  // a < b
        double value = 0.0;
    };
    const std::vector<Weight>& weights() const noexcept { return weights_; }

private:
    struct Count {
        std::uint32_t from = 0, to = 0;
        std::uint32_t rays = 0;
    };
    void cast_nodes(std::uint32_t first,
                    std::uint32_t last,
                    std::span<const std::uint64_t> rays_until,
                    std::vector<Count>& counts);
    std::vector<std::optional<std::uint32_t>> nodes_of(
        std::span<const geometry::Ray> rays, std::span<const std::optional<geometry::Hit>> hits);
    void weigh(const std::vector<Count>& counts);
    void add_weight(std::uint32_t a, std::uint32_t b, double value);

    bvh::MeshBvh bvh_;
    const SideNodes& nodes_;
    const AirCutOptions& options_;
    Executor& executor_;
    std::vector<std::uint64_t> rays_of_node_;
    std::vector<Weight> weights_;          // by (a, b)
    std::vector<Weight> opening_weights_;  // in any order
    std::vector<FlowEdge> ties_;           // to air and solid
    std::uint64_t rays_ = 0;
};

}  // namespace earshot::visibility
