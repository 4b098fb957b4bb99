// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/wide_node.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

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

namespace {

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

}  // namespace earshot::bvh
