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

// Every triangle a ray hits, nearest first and by TriangleId where several are hit at the same t.
// Trees are those of ray.h, and hits are decided as closest_hit() decides them: it gives the first
// of these. A ray through an edge hits the triangles on both sides of it.

/// The hits of one ray, one at a time. Boxes are opened in the order in which the ray enters them
/// (Hjaltason and Samet 1999), so the work ends where the caller stops asking.
class OrderedHits {
public:
    /// Precondition: tree and mesh stay as they are while hits are asked for.
    OrderedHits(const Tree& tree, const geometry::MeshView& mesh, const geometry::Ray& ray);

    /// The next hit; empty after the last.
    std::optional<geometry::Hit> next();

private:
    struct Waiting {
        std::uint32_t node = 0;
        double near = 0.0;
    };

    void wait_for(std::uint32_t node);
    void open(std::uint32_t node);

    const Tree& tree_;
    geometry::MeshView mesh_;
    geometry::PreparedRay ray_;
    std::vector<Waiting> waiting_;     // a heap with the nearest node on top
    std::vector<geometry::Hit> hits_;  // a heap with the first hit on top
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
