// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>

namespace earshot::bvh {

using geometry::Aabb;

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
    // Octants 0 ... 3 have a positive z; the opposite octants have the reverse orders.
    for (std::uint32_t octant = 0; octant < 4; ++octant) {
        std::array<float, kWidth> keys{};
        std::array<std::uint32_t, kWidth> ranked{};
        for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
            const auto& c = centres[slot];
            const float key =
                ((octant & 1U) != 0 ? -c[0] : c[0]) + ((octant & 2U) != 0 ? -c[1] : c[1]) + c[2];
            // Insertion sort, farthest first; stable, so that empty slots do not matter.
            std::size_t rank = slot;
            for (; rank > 0 && keys[rank - 1] < key; --rank) {
                keys[rank] = keys[rank - 1];
                ranked[rank] = ranked[rank - 1];
            }
            keys[rank] = key;
            ranked[rank] = slot;
        }
        for (std::size_t rank = 0; rank < kWidth; ++rank) {
            order[rank] |= ranked[rank] << (3 * octant);
            order[kWidth - 1 - rank] |= ranked[rank] << (3 * (7 - octant));
        }
    }
    std::copy(order.begin(), order.end(), node.order);
}

namespace {

/// Writes the vertices in single precision and returns their box.
Aabb pack_single_leaf(std::uint32_t* words,
                      std::size_t count,
                      const geometry::MeshView& mesh) noexcept {
    // Rounding is monotone, so the box of all vertices is rounded once.
    geometry::Vec3 lower(std::numeric_limits<double>::infinity());
    geometry::Vec3 upper(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t* word = words + i;
        for (const geometry::VertexId vertex : mesh.triangles[words[9 * count + i]]) {
            const geometry::Vec3& position = mesh.positions[vertex];
            for (int axis = 0; axis < 3; ++axis) {
                const double value = position[axis];
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

/// Steps from `lower` to `value`, 0 to 65535.
std::uint16_t steps_to(double value, float lower, float step) noexcept {
    const double steps = (value - static_cast<double>(lower)) / static_cast<double>(step) + 0.5;
    // What is not a number, as without a step, goes to 0.
    return !(steps >= 0.0) ? std::uint16_t{0}
                           : static_cast<std::uint16_t>(std::min(steps, 65535.0));
}

/// Writes the quantisation frame and the vertices in it, and returns their box. No coordinate moves
/// by more than half a step.
Aabb pack_quantised_leaf(std::uint32_t* words,
                         std::size_t count,
                         const geometry::MeshView& mesh) noexcept {
    constexpr LeafEncoding kEncoding = LeafEncoding::quantised;
    const std::size_t before = triangle_ids_offset(kEncoding, count);
    const std::uint32_t* triangles = words + before;
    std::array<std::uint32_t, 10 * kMaxLeafTriangles> single;
    std::copy_n(triangles, count, single.begin() + static_cast<std::ptrdiff_t>(9 * count));
    const Aabb box = pack_single_leaf(single.data(), count, mesh);
    float extent = 0.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        extent = std::max(extent, box.upper[axis] - box.lower[axis]);
        words[axis] = std::bit_cast<std::uint32_t>(box.lower[axis]);
    }
    // Longer by more than the roundings, so that the last coordinate is not beyond 65535 steps.
    const float step = extent * (1.0F + 0x1p-20F) / 65535.0F;
    words[3] = std::bit_cast<std::uint32_t>(step);
    // Gaps hold zeros, so that equal trees have equal bytes.
    words[before - 1] = 0;
    std::fill(words + before + count,
              words + words_per_block(kEncoding) * leaf_blocks(kEncoding, count),
              0U);
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t run = 0;
        for (const geometry::VertexId vertex : mesh.triangles[triangles[i]]) {
            for (std::size_t axis = 0; axis < 3; ++axis, ++run) {
                const double value = mesh.positions[vertex][static_cast<int>(axis)];
                const std::uint16_t steps = steps_to(value, box.lower[axis], step);
                std::memcpy(reinterpret_cast<char*>(words + kQuantisationFrameWords) +
                                2 * (run * count + i),
                            &steps,
                            sizeof steps);
            }
        }
    }
    return box;
}

}  // namespace

Aabb pack_leaf(LeafEncoding encoding,
               std::uint32_t* words,
               std::size_t count,
               const geometry::MeshView& mesh) noexcept {
    return encoding == LeafEncoding::single ? pack_single_leaf(words, count, mesh)
                                            : pack_quantised_leaf(words, count, mesh);
}

void prefetch_triangles(std::span<const std::uint32_t> triangles,
                        const geometry::MeshView& mesh) noexcept {
    for (const std::uint32_t triangle : triangles) {
        __builtin_prefetch(&mesh.triangles[triangle]);
    }
}

void prefetch_vertices(std::span<const std::uint32_t> triangles,
                       const geometry::MeshView& mesh) noexcept {
    for (const std::uint32_t triangle : triangles) {
        for (const geometry::VertexId vertex : mesh.triangles[triangle]) {
            __builtin_prefetch(&mesh.positions[vertex]);
        }
    }
}

}  // namespace earshot::bvh
