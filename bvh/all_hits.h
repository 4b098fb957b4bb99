// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"
#include "earshot/geometry/intersect.h"
#include "earshot/geometry/mesh.h"

#include <concepts>
#include <cstdint>
#include <optional>
#include <vector>

namespace earshot::bvh {

// All triangles that a ray hits, in the order of better_hit(). Trees are those of ray.h, and hits
// are decided as closest_hit() decides them: it returns the first of these. A ray through an edge
// hits the triangles on both sides of it.

/// The hits of one ray, one at a time: an incremental traversal that expands nodes in the order in
/// which the ray enters their boxes, by a priority queue (Hjaltason and Samet 1999), so that hits
/// beyond the last one asked for cost nothing.
class OrderedHits {
public:
    /// Precondition: tree and mesh do not change while this exists.
    OrderedHits(const Tree& tree, const geometry::MeshView& mesh, const geometry::Ray& ray);

    /// The next hit; empty after the last.
    std::optional<geometry::Hit> next();

private:
    struct QueueEntry {
        std::uint32_t node = 0;
        double t_near = 0.0;  // where the ray enters the node's box
    };

    static bool is_farther(const QueueEntry& a, const QueueEntry& b) noexcept {
        return a.t_near > b.t_near;
    }
    void push_node(std::uint32_t node);
    void expand(std::uint32_t node);

    const Tree& tree_;
    geometry::MeshView mesh_;
    geometry::PreparedRay ray_;
    std::vector<QueueEntry> nodes_;    // a heap with the closest node on top
    std::vector<geometry::Hit> hits_;  // a heap with the best hit on top
};

/// All hits in order.
std::vector<geometry::Hit> all_hits(const Tree& tree,
                                    const geometry::MeshView& mesh,
                                    const geometry::Ray& ray);

/// Calls visit(hit) for all hits in order until it returns false.
template <std::predicate<const geometry::Hit&> Visit>
void visit_hits(const Tree& tree,
                const geometry::MeshView& mesh,
                const geometry::Ray& ray,
                Visit&& visit) {
    OrderedHits hits(tree, mesh, ray);
    while (const auto hit = hits.next()) {
        if (!visit(*hit)) {
            return;
        }
    }
}

}  // namespace earshot::bvh
