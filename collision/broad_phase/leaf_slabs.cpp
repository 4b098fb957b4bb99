// SPDX-License-Identifier: MIT
#include "earshot/collision/broad_phase/internal/leaf_slabs.h"

#include "earshot/geometry/aabb.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

namespace {

/// The gap that rounding cannot close between projections onto a normal whose absolute components
/// sum to 1. An offset is rounded twice, products and sums five times, both extents are off, and no
/// intermediate result exceeds the largest offset.
float gap_error(double largest, double margin) {
    constexpr double kLargest = 1e37;  // so that sums of three are finite
    return largest < kLargest && margin < kLargest
               ? geometry::round_up(2.0 * margin * (1.0 + 0x1p-20) + 0x1p-20 * largest + 0x1p-140)
               : std::numeric_limits<float>::infinity();
}

}  // namespace

void LeafSlabs::build(const MovingScene& scene, const SweptBvh& swept_bvh) {
    const std::span<const bvh::Node> nodes = swept_bvh.tree().nodes();
    leaf_of_node_.assign(nodes.size(), 0);
    nodes_.clear();
    blocks_of_.clear();
    vertices_.clear();
    leaves_of_mesh_.assign(scene.meshes(), {});
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) {
            continue;
        }
        const std::size_t first = vertices_.size();
        const SlotRange slots = swept_bvh.slots_of_node(i);
        for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
            const Triangle& triangle = scene.triangles[swept_bvh.triangle(slot)];
            vertices_.insert(vertices_.end(), triangle.begin(), triangle.end());
        }
        const auto start = vertices_.begin() + static_cast<std::ptrdiff_t>(first);
        std::sort(start, vertices_.end());
        vertices_.erase(std::unique(start, vertices_.end()), vertices_.end());
        const VertexId last = vertices_.back();
        vertices_.resize((vertices_.size() + kLanes - 1) / kLanes * kLanes, last);
        leaf_of_node_[i] = static_cast<std::uint32_t>(nodes_.size());
        // A leaf holds triangles of one mesh, and the leaves of a mesh are neighbours.
        IndexRange& leaves = leaves_of_mesh_[swept_bvh.mesh_of_node(i)];
        leaves.begin = leaves.end == 0 ? leaf_of_node_[i] : leaves.begin;
        leaves.end = leaf_of_node_[i] + 1;
        nodes_.push_back(i);
        blocks_of_.push_back({static_cast<std::uint32_t>(first / kLanes),
                              static_cast<std::uint32_t>(vertices_.size() / kLanes)});
    }
    blocks_.resize(vertices_.size() / kLanes);
    changed_meshes_.reset();
}

/// Moves the origin to the middle of the scene's box where it has come to be far from it, so that
/// all leaves have to follow; errors grow with the distance of the farthest vertex.
void LeafSlabs::follow_box(const geometry::Aabb& box, double margin) {
    constexpr double kFar = 0.125;  // of half the largest side
    Vec3 middle(0.0), half(0.0);
    for (std::uint8_t axis = 0; axis < 3; ++axis) {
        const double lower = box.lower[axis], upper = box.upper[axis];
        middle[axis] = 0.5 * (lower + upper);
        half[axis] = 0.5 * (upper - lower);
    }
    const auto largest = [](const Vec3& v) {
        return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    };
    if (!(largest(middle - origin_) <= kFar * largest(half))) {
        origin_ = middle;
        changed_meshes_.reset();
    }
    error_ = gap_error(largest(half + glm::abs(middle - origin_)), margin);
}

void LeafSlabs::update(const MovingScene& scene,
                       const SweptBvh& swept_bvh,
                       double margin,
                       Executor& executor) {
    leaf_slabs_.resize(nodes_.size());
    if (nodes_.empty()) {
        return;
    }
    follow_box(swept_bvh.tree().nodes()[0].box, margin);
    for_each_index(ranges_of(changed_meshes_.take(scene),
                             [&](std::uint32_t mesh) { return leaves_of_mesh_[mesh]; }),
                   1024,
                   executor,
                   [&](std::uint32_t leaf) {
                       copy_vertices(scene, leaf);
                       leaf_slabs_[leaf] = slab(scene, swept_bvh, leaf);
                   });
}

void LeafSlabs::copy_vertices(const MovingScene& scene, std::size_t leaf) {
    for (std::uint32_t i = blocks_of_[leaf].begin; i < blocks_of_[leaf].end; ++i) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const VertexId vertex = vertices_[i * kLanes + lane];
            const Vec3 begin = scene.begin[vertex] - origin_;
            const Vec3 end = scene.end[vertex] - origin_;
            for (int axis = 0; axis < 3; ++axis) {
                blocks_[i].begin[static_cast<std::size_t>(axis)][lane] =
                    static_cast<float>(begin[axis]);
                blocks_[i].end[static_cast<std::size_t>(axis)][lane] =
                    static_cast<float>(end[axis]);
            }
        }
    }
}

LeafSlabs::Slab LeafSlabs::slab(const MovingScene& scene,
                                const SweptBvh& swept_bvh,
                                std::size_t leaf) const {
    // The area-weighted mean normal half-way through the step, scaled to a largest component of 1.
    Vec3 normal(0.0);
    const SlotRange slots = swept_bvh.slots_of_node(nodes_[leaf]);
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
        const Triangle& t = scene.triangles[swept_bvh.triangle(slot)];
        const auto half_way = [&](VertexId vertex) {
            return 0.5 * (scene.begin[vertex] + scene.end[vertex]);
        };
        normal += glm::cross(half_way(t[1]) - half_way(t[0]), half_way(t[2]) - half_way(t[0]));
    }
    const Vec3 sizes = glm::abs(normal);
    const double size = std::max({sizes.x, sizes.y, sizes.z});
    Slab slab;
    float length = 0.0F;
    for (int axis = 0; axis < 3 && size > 0.0 && std::isfinite(size); ++axis) {
        float& component = slab.normal[static_cast<std::size_t>(axis)];
        component = static_cast<float>(normal[axis] / size);
        length += std::abs(component);
    }
    slab.length = length * (1.0F + 0x1p-20F);
    slab.begin = extent(&Block::begin, blocks_of_[leaf], slab.normal);
    slab.end = extent(&Block::end, blocks_of_[leaf], slab.normal);
    return slab;
}

LeafSlabs::Extent LeafSlabs::extent(std::array<Lanes, 3> Block::*time,
                                    SlotRange blocks,
                                    const std::array<float, 3>& normal) const noexcept {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Lanes lower{kInfinity, kInfinity, kInfinity, kInfinity};
    Lanes upper{-kInfinity, -kInfinity, -kInfinity, -kInfinity};
    for (std::uint32_t i = blocks.begin; i < blocks.end; ++i) {
        const auto& [x, y, z] = blocks_[i].*time;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const float height = x[lane] * normal[0] + y[lane] * normal[1] + z[lane] * normal[2];
            lower[lane] = std::min(lower[lane], height);
            upper[lane] = std::max(upper[lane], height);
        }
    }
    return {std::min(std::min(lower[0], lower[1]), std::min(lower[2], lower[3])),
            std::max(std::max(upper[0], upper[1]), std::max(upper[2], upper[3]))};
}

bool LeafSlabs::separates(const Slab& slab, SlotRange blocks) const noexcept {
    const float error = error_ * slab.length;  // gaps up to this may be rounding
    const auto side = [&](const Extent& own, const Extent& other) {
        return other.lower - own.upper > error ? 1 : own.lower - other.upper > error ? -1 : 0;
    };
    const int begin = side(slab.begin, extent(&Block::begin, blocks, slab.normal));
    return begin != 0 && begin == side(slab.end, extent(&Block::end, blocks, slab.normal));
}

}  // namespace earshot::collision
