// SPDX-License-Identifier: MIT
#include "earshot/collision/internal/leaf_plates.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::collision {

using geometry::Triangle;
using geometry::Vec3;
using geometry::VertexId;

void LeafPlates::build(const MovingScene& scene, const SweptForest& forest) {
    const std::span<const bvh::Node> nodes = forest.tree().nodes();
    leaf_of_node_.assign(nodes.size(), 0);
    nodes_.clear();
    vertices_of_.clear();
    vertices_.clear();
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) {
            continue;
        }
        const auto first = static_cast<std::ptrdiff_t>(vertices_.size());
        const SlotRange slots = forest.slots_of_node(i);
        for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
            const Triangle& triangle = scene.triangles[forest.triangle(slot)];
            vertices_.insert(vertices_.end(), triangle.begin(), triangle.end());
        }
        std::sort(vertices_.begin() + first, vertices_.end());
        vertices_.erase(std::unique(vertices_.begin() + first, vertices_.end()), vertices_.end());
        leaf_of_node_[i] = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back(i);
        vertices_of_.push_back(
            {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(vertices_.size())});
    }
}

void LeafPlates::update(const MovingScene& scene,
                        const SweptForest& forest,
                        double margin,
                        Executor& executor) {
    margin_ = margin;
    plates_.resize(nodes_.size());
    executor.for_each(plates_.size(), 1024, [&](std::size_t from, std::size_t to) {
        for (std::size_t leaf = from; leaf < to; ++leaf) {
            plates_[leaf] = plate(scene, forest, leaf);
        }
    });
}

LeafPlates::Plate LeafPlates::plate(const MovingScene& scene,
                                    const SweptForest& forest,
                                    std::size_t leaf) const {
    Plate plate;
    plate.origin = scene.begin[vertices_[vertices_of_[leaf].begin]];
    const SlotRange slots = forest.slots_of_node(nodes_[leaf]);
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
        const Triangle& t = scene.triangles[forest.triangle(slot)];
        const auto half_way = [&](VertexId vertex) {
            return 0.5 * (scene.begin[vertex] + scene.end[vertex]);
        };
        plate.normal +=
            glm::cross(half_way(t[1]) - half_way(t[0]), half_way(t[2]) - half_way(t[0]));
    }
    plate.length = std::abs(plate.normal.x) + std::abs(plate.normal.y) + std::abs(plate.normal.z);
    plate.begin = extent(scene.begin, vertices_of_[leaf], plate);
    plate.end = extent(scene.end, vertices_of_[leaf], plate);
    return plate;
}

LeafPlates::Extent LeafPlates::extent(std::span<const Vec3> points,
                                      SlotRange vertices,
                                      const Plate& plate) const noexcept {
    Extent extent;
    Vec3 largest(0.0);
    for (std::uint32_t i = vertices.begin; i < vertices.end; ++i) {
        const Vec3 offset = points[vertices_[i]] - plate.origin;
        const double place = glm::dot(offset, plate.normal);
        extent.lower = i == vertices.begin ? place : std::min(extent.lower, place);
        extent.upper = i == vertices.begin ? place : std::max(extent.upper, place);
        largest = glm::max(largest, glm::abs(offset));
    }
    extent.size = std::max({largest.x, largest.y, largest.z});
    return extent;
}

int LeafPlates::side(const Extent& own, const Extent& other, double length) const noexcept {
    // A place is rounded some eight times; products do not vanish beside their bound.
    const double room =
        (2.0 * margin_ + 0x1p-48 * std::max(own.size, other.size)) * length + 1e-290;
    return other.lower - own.upper > room ? 1 : own.lower - other.upper > room ? -1 : 0;
}

bool LeafPlates::is_beside(const MovingScene& scene,
                           const Plate& plate,
                           SlotRange vertices) const noexcept {
    const int begin = side(plate.begin, extent(scene.begin, vertices, plate), plate.length);
    return begin != 0 && begin == side(plate.end, extent(scene.end, vertices, plate), plate.length);
}

}  // namespace earshot::collision
