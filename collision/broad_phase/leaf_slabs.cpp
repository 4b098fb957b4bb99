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

/// What must lie between places along a normal whose magnitudes sum up to 1, so that rounding does
/// not matter. An offset is rounded twice, products and sums five times, and bounds on both sides
/// are off; nothing is larger than the largest offset.
float room_for(double largest, double margin) {
    constexpr double kLargest = 1e37;  // sums of three are finite
    return largest < kLargest && margin < kLargest
               ? geometry::round_up(2.0 * margin * (1.0 + 0x1p-20) + 0x1p-20 * largest + 0x1p-140)
               : std::numeric_limits<float>::infinity();
}

}  // namespace

void LeafPlates::build(const MovingScene& scene, const SweptForest& forest) {
    const std::span<const bvh::Node> nodes = forest.tree().nodes();
    leaf_of_node_.assign(nodes.size(), 0);
    nodes_.clear();
    blocks_of_.clear();
    vertices_.clear();
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) {
            continue;
        }
        const std::size_t first = vertices_.size();
        const SlotRange slots = forest.slots_of_node(i);
        for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
            const Triangle& triangle = scene.triangles[forest.triangle(slot)];
            vertices_.insert(vertices_.end(), triangle.begin(), triangle.end());
        }
        const auto start = vertices_.begin() + static_cast<std::ptrdiff_t>(first);
        std::sort(start, vertices_.end());
        vertices_.erase(std::unique(start, vertices_.end()), vertices_.end());
        const VertexId last = vertices_.back();
        vertices_.resize((vertices_.size() + kLanes - 1) / kLanes * kLanes, last);
        leaf_of_node_[i] = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back(i);
        blocks_of_.push_back({static_cast<std::uint32_t>(first / kLanes),
                              static_cast<std::uint32_t>(vertices_.size() / kLanes)});
    }
    blocks_.resize(vertices_.size() / kLanes);
}

void LeafPlates::update(const MovingScene& scene,
                        const SweptForest& forest,
                        double margin,
                        Executor& executor) {
    plates_.resize(nodes_.size());
    if (nodes_.empty()) {
        return;
    }
    const geometry::Aabb& all = forest.tree().nodes()[0].box;
    Vec3 half(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = all.lower[axis], upper = all.upper[axis];
        origin_[axis] = 0.5 * (lower + upper);
        half[axis] = 0.5 * (upper - lower);
    }
    room_ = room_for(std::max({half.x, half.y, half.z}), margin);
    executor.for_each(plates_.size(), 1024, [&](std::size_t from, std::size_t to) {
        for (std::size_t leaf = from; leaf < to; ++leaf) {
            place_vertices(scene, leaf);
            plates_[leaf] = plate(scene, forest, leaf);
        }
    });
}

void LeafPlates::place_vertices(const MovingScene& scene, std::size_t leaf) {
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

LeafPlates::Plate LeafPlates::plate(const MovingScene& scene,
                                    const SweptForest& forest,
                                    std::size_t leaf) const {
    Vec3 normal(0.0);
    const SlotRange slots = forest.slots_of_node(nodes_[leaf]);
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
        const Triangle& t = scene.triangles[forest.triangle(slot)];
        const auto half_way = [&](VertexId vertex) {
            return 0.5 * (scene.begin[vertex] + scene.end[vertex]);
        };
        normal += glm::cross(half_way(t[1]) - half_way(t[0]), half_way(t[2]) - half_way(t[0]));
    }
    const Vec3 sizes = glm::abs(normal);
    const double size = std::max({sizes.x, sizes.y, sizes.z});
    Plate plate;
    float length = 0.0F;
    for (int axis = 0; axis < 3 && size > 0.0 && std::isfinite(size); ++axis) {
        float& component = plate.normal[static_cast<std::size_t>(axis)];
        component = static_cast<float>(normal[axis] / size);
        length += std::abs(component);
    }
    plate.room = room_ * (length * (1.0F + 0x1p-20F));
    plate.begin = extent(&Block::begin, blocks_of_[leaf], plate.normal);
    plate.end = extent(&Block::end, blocks_of_[leaf], plate.normal);
    return plate;
}

LeafPlates::Extent LeafPlates::extent(std::array<Lanes, 3> Block::*time,
                                      SlotRange blocks,
                                      const std::array<float, 3>& normal) const noexcept {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Lanes least{kInfinity, kInfinity, kInfinity, kInfinity};
    Lanes most{-kInfinity, -kInfinity, -kInfinity, -kInfinity};
    for (std::uint32_t i = blocks.begin; i < blocks.end; ++i) {
        const auto& [x, y, z] = blocks_[i].*time;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const float place = x[lane] * normal[0] + y[lane] * normal[1] + z[lane] * normal[2];
            least[lane] = std::min(least[lane], place);
            most[lane] = std::max(most[lane], place);
        }
    }
    return {std::min(std::min(least[0], least[1]), std::min(least[2], least[3])),
            std::max(std::max(most[0], most[1]), std::max(most[2], most[3]))};
}

bool LeafPlates::is_beside(const Plate& plate, SlotRange blocks) const noexcept {
    const auto side = [&](const Extent& own, const Extent& other) {
        return other.lower - own.upper > plate.room   ? 1
               : own.lower - other.upper > plate.room ? -1
                                                      : 0;
    };
    const int begin = side(plate.begin, extent(&Block::begin, blocks, plate.normal));
    return begin != 0 && begin == side(plate.end, extent(&Block::end, blocks, plate.normal));
}

}  // namespace earshot::collision
