// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_node.h"

#include "earshot/geometry/intersect.h"

#include <algorithm>
#include <array>
#include <bit>

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
    Aabb box;
    for (std::size_t i = 0; i < count; ++i) {
        const geometry::Triangle& triangle = mesh.triangles[words[9 * count + i]];
        const std::array<const geometry::Vec3*, 3> corners = {&mesh.positions[triangle[0]],
                                                              &mesh.positions[triangle[1]],
                                                              &mesh.positions[triangle[2]]};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto value =
                    static_cast<float>((*corners[corner])[static_cast<glm::length_t>(axis)]);
                words[(3 * corner + axis) * count + i] = std::bit_cast<std::uint32_t>(value);
            }
        }
        box.include(geometry::triangle_box(*corners[0], *corners[1], *corners[2]));
    }
    return box;
}

}  // namespace earshot::bvh
