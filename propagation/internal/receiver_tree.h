// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <glm/geometric.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// A hierarchy of spheres over the balls of receivers, which finds those that a leg of a ray may
/// cross in less time than a look at each takes.
class ReceiverTree {
public:
    struct Ball {
        geometry::Vec3 centre{0.0};
        double radius = 0.0;
    };

    ReceiverTree() = default;
    /// O(n log n) for n balls.
    explicit ReceiverTree(std::span<const Ball> balls);

    /// Calls visit(index) once for each ball that the ray may meet before the distance `end`, and
    /// perhaps for others near it, in an order that depends on the balls alone. Precondition: the
    /// direction has length 1, up to rounding.
    template <typename Visit>
    void visit(const geometry::Ray& ray, double end, Visit&& visit) const {
        // Nodes are in depth-first order: a node that is missed names the one after its subtree.
        for (std::uint32_t i = 0; i < nodes_.size();) {
            const Node& node = nodes_[i];
            if (!may_meet(node, ray, end)) {
                i = node.next;
                continue;
            }
            for (std::uint32_t k = node.begin; k < node.end; ++k) {
                visit(std::size_t{order_[k]});
            }
            ++i;
        }
    }

private:
    struct Node {
        geometry::Vec3 centre{0.0};
        double radius = 0.0;  // of a sphere that holds all balls below, and more than rounding
        std::uint32_t begin = 0, end = 0;  // into order_: the balls of a leaf; none of other nodes
        std::uint32_t next = 0;            // the node after this subtree
    };

    static bool may_meet(const Node& node, const geometry::Ray& ray, double end) noexcept {
        const geometry::Vec3 to = node.centre - ray.origin;
        const double along = glm::dot(to, ray.direction);
        const double squared = glm::dot(to, to);
        const double radius_squared = node.radius * node.radius;
        // The rounding of the difference grows with the distance.
        constexpr double kRounding = 1e-12;
        return squared - along * along <= radius_squared + kRounding * squared &&
               along >= -node.radius && along <= end + node.radius;
    }
    void build(std::span<const Ball> balls, std::uint32_t begin, std::uint32_t end);

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;
};

}  // namespace earshot::propagation
