// SPDX-License-Identifier: MIT
#include "earshot/base/assert.h"
#include "earshot/bvh/internal/bottom_up.h"

namespace earshot::bvh {

void Tree::refit(std::span<const geometry::Aabb> boxes, Executor& executor) {
    EARSHOT_ASSERT(boxes.size() == primitives_.size());
    for_each_bottom_up(nodes_, executor, [&](std::size_t index) {
        Node& node = nodes_[index];
        geometry::Aabb box;
        if (node.is_leaf()) {
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                box.include(boxes[primitives_[i]]);
            }
        } else {
            box = nodes_[node.first].box;
            box.include(nodes_[node.first + 1].box);
        }
        node.box = box;
    });
}

}  // namespace earshot::bvh
