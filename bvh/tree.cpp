// SPDX-License-Identifier: MIT
#include "earshot/bvh/tree.h"

#include "earshot/geometry/intersect.h"

namespace earshot::bvh {

std::vector<geometry::Aabb> triangle_boxes(const geometry::MeshView& mesh, Executor& executor) {
    constexpr std::size_t kGrain = 16384;
    std::vector<geometry::Aabb> boxes(mesh.triangles.size());
    executor.for_each(boxes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const geometry::Triangle& triangle = mesh.triangles[i];
            boxes[i] = geometry::triangle_box(mesh.positions[triangle[0]],
                                              mesh.positions[triangle[1]],
                                              mesh.positions[triangle[2]]);
        }
    });
    return boxes;
}

}  // namespace earshot::bvh
