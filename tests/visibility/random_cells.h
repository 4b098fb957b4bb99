// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/visibility/view_cells.h"

#include <glm/geometric.hpp>

#include "support/meshes.h"
#include <vector>

namespace earshot::test {

/// The cube of half-width 1 in so many leaves: planes of any direction through random points, each
/// dividing the leaf that its point is in. All volumes are given as equal, which they are not.
inline visibility::ViewCells random_cells(std::uint64_t seed, std::uint32_t leaves) {
    using namespace visibility;
    const ViewRegion cube = {geometry::Vec3(-1.0), geometry::Vec3(1.0)};
    std::vector<CellNode> nodes;
    for (std::uint32_t added = 1; added < leaves; ++added) {
        const geometry::Vec3 place = random_point(seed, 2 * added);
        const geometry::Vec3 normal = glm::normalize(random_point(seed, 2 * added + 1));
        std::uint32_t root = nodes.empty() ? kCellLeaf : 0;
        std::uint32_t* child = &root;
        while ((*child & kCellLeaf) == 0) {
            CellNode& node = nodes[*child];
            child = glm::dot(node.normal, place) < node.offset ? &node.back : &node.front;
        }
        const std::uint32_t leaf = *child;
        *child = static_cast<std::uint32_t>(nodes.size());
        nodes.push_back({normal, glm::dot(normal, place), leaf, kCellLeaf + added});
    }
    return {cube, std::move(nodes), std::vector<double>(leaves, 8.0 / leaves)};
}

}  // namespace earshot::test
