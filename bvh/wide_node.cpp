// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace earshot::bvh {

using geometry::Aabb;

Aabb slot_box(const WideNode& node, std::size_t slot) noexcept {
    Aabb box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lower[axis] = node.planes[2 * axis][slot];
        box.upper[axis] = node.planes[2 * axis + 1][slot];
    }
    return box;
}

void set_slot_box(WideNode& node, std::size_t slot, const Aabb& box) noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        node.planes[2 * axis][slot] = box.lower[axis];
        node.planes[2 * axis + 1][slot] = box.upper[axis];
    }
}

Aabb box_of(const WideNode& node) noexcept {
    Aabb box;
    for (std::size_t slot = 0; slot < WideNode::kWidth; ++slot) {
        box.include(slot_box(node, slot));
    }
    return box;
}

void set_order(WideNode& node) noexcept {
    constexpr std::size_t kWidth = WideNode::kWidth;
    std::array<std::array<float, 3>, kWidth> centres{};  // doubled
    for (std::size_t slot = 0; slot < kWidth; ++slot) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            centres[slot][axis] = node.planes[2 * axis][slot] + node.planes[2 * axis + 1][slot];
        }
    }
    std::array<std::uint32_t, kWidth> order{};
    // Octants 0 ... 3 have a positive z; the others see the same order from behind.
    for (std::uint32_t octant = 0; octant < 4; ++octant) {
        std::array<float, kWidth> keys{};
        std::array<std::uint32_t, kWidth> ranked{};
        for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
            const auto& c = centres[slot];
            const float key =
                ((octant & 1U) != 0 ? -c[0] : c[0]) + ((octant & 2U) != 0 ? -c[1] : c[1]) + c[2];
            std::size_t place = slot;
            for (; place > 0 && keys[place - 1] < key; --place) {
                keys[place] = keys[place - 1];
                ranked[place] = ranked[place - 1];
            }
            keys[place] = key;
            ranked[place] = slot;
        }
        for (std::size_t r = 0; r < kWidth; ++r) {
            order[r] |= ranked[r] << (3 * octant);
            order[kWidth - 1 - r] |= ranked[r] << (3 * (7 - octant));
        }
    }
    std::copy(order.begin(), order.end(), node.order);
}

Aabb fill_leaf(std::uint32_t* words, std::size_t count, const geometry::MeshView& mesh) noexcept {
    // Rounding is monotone, so the box of all corners is rounded once.
    geometry::Vec3 lower(std::numeric_limits<double>::infinity());
    geometry::Vec3 upper(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t* word = words + i;
        for (const geometry::VertexId vertex : mesh.triangles[words[9 * count + i]]) {
            const geometry::Vec3& corner = mesh.positions[vertex];
            for (int axis = 0; axis < 3; ++axis) {
                const double value = corner[axis];
                lower[axis] = value < lower[axis] ? value : lower[axis];
                upper[axis] = value > upper[axis] ? value : upper[axis];
                *word = std::bit_cast<std::uint32_t>(static_cast<float>(value));
                word += count;
            }
        }
    }
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        box.lower[k] = geometry::round_down(lower[axis]);
        box.upper[k] = geometry::round_up(upper[axis]);
    }
    return box;
}

void fetch_leaf_triangles(const std::uint32_t* words,
                          std::size_t count,
                          const geometry::MeshView& mesh) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
        __builtin_prefetch(&mesh.triangles[words[9 * count + i]]);
    }
}

void fetch_leaf_corners(const std::uint32_t* words,
                        std::size_t count,
                        const geometry::MeshView& mesh) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
        for (const geometry::VertexId vertex : mesh.triangles[words[9 * count + i]]) {
            __builtin_prefetch(&mesh.positions[vertex]);
        }
    }
}

}  // namespace earshot::bvh
