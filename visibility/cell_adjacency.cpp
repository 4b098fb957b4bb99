// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/cell_adjacency.h"

#include "earshot/visibility/cell_shape.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace earshot::visibility {

using geometry::Vec3;

namespace {

using Polygon = std::vector<Vec3>;

Vec3 twice_area(const Polygon& polygon) {
    Vec3 sum(0.0);
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        sum += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    }
    return sum;
}

/// The part of a convex polygon on one side; `heights` holds one per corner.
Polygon part_of(const Polygon& polygon, const std::vector<double>& heights, double side) {
    Polygon part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::size_t next = (i + 1) % polygon.size();
        const double here = side * heights[i];
        const double there = side * heights[next];
        if (here >= 0.0) {
            part.push_back(polygon[i]);
        }
        if ((here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0)) {
            part.push_back(polygon[i] + here / (here - there) * (polygon[next] - polygon[i]));
        }
    }
    return part;
}

class AdjacencyFinder {
public:
    explicit AdjacencyFinder(const ViewCells& cells)
        : cells_(cells), slack_(plane_slack(cells.region())) {}

    /// Passes a polygon on a leaf's face down the tree, to the leaves on the face's other side.
    void descend(LeafId leaf, const Polygon& face, const Vec3& outward, std::uint32_t child) {
        if ((child & kCellLeaf) != 0) {
            const LeafId other = child & ~kCellLeaf;
            const double area = 0.5 * glm::length(twice_area(face));
            if (area > slack_ * slack_) {
                found.push_back({std::min(leaf, other), std::max(leaf, other), area});
            }
            return;
        }
        const CellNode& node = cells_.nodes()[child];
        const double slack = slack_ * glm::length(node.normal);
        std::vector<double> heights(face.size());
        for (std::size_t i = 0; i < face.size(); ++i) {
            const double height = glm::dot(node.normal, face[i]) - node.offset;
            heights[i] = std::abs(height) <= slack ? 0.0 : height;
        }
        const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
        if (*low == 0.0 && *high == 0.0) {
            // The polygon lies in the plane: the leaves beyond the face are on its outer side.
            const bool is_front = glm::dot(node.normal, outward) > 0.0;
            descend(leaf, face, outward, is_front ? node.front : node.back);
        } else if (*high <= 0.0) {
            descend(leaf, face, outward, node.back);
        } else if (*low >= 0.0) {
            descend(leaf, face, outward, node.front);
        } else {
            descend(leaf, part_of(face, heights, -1.0), outward, node.back);
            descend(leaf, part_of(face, heights, 1.0), outward, node.front);
        }
    }

    std::vector<CellAdjacency> found;

private:
    const ViewCells& cells_;
    double slack_;
};

}  // namespace

std::vector<CellAdjacency> cell_adjacencies(const ViewCells& cells) {
    AdjacencyFinder finder(cells);
    const auto shapes = leaf_shapes(cells);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        for (const CellFace& face : shapes[i].faces()) {
            if (face.node == kBorder) {
                continue;
            }
            Polygon polygon;
            for (const std::uint32_t corner : face.corners) {
                polygon.push_back(shapes[i].corners()[corner]);
            }
            const Vec3 outward = twice_area(polygon);
            const CellNode& node = cells.nodes()[face.node];
            // Each patch is found once, from the leaf behind the plane.
            if (glm::dot(outward, node.normal) > 0.0) {
                finder.descend(static_cast<LeafId>(i), polygon, outward, node.front);
            }
        }
    }
    std::sort(finder.found.begin(), finder.found.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    return std::move(finder.found);
}

}  // namespace earshot::visibility
