// SPDX-License-Identifier: MIT
//
// Questions about distance: where is a mesh nearest to a point, and what of it lies within reach?

#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/overlap.h"

#include <iostream>

int main() {
    using namespace earshot;
    // A pyramid of 4 x 4 x 3 metres without a floor.
    const geometry::Mesh roof{{{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}, {0, 3, 0}},
                              {{0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}}};
    const auto tree = bvh::Tree::build(bvh::triangle_boxes(roof.view()));

    const geometry::Vec3 lamp{0.5, 1.0, 0.0};
    if (const auto near = bvh::closest_point(tree, roof.view(), lamp)) {
        std::cout << "The lamp hangs " << near->distance << " m from triangle " << near->triangle
                  << ", at " << near->point.x << ", " << near->point.y << ", " << near->point.z
                  << "\n";
    }

    // A corner that weighs 0 is not part of what is nearest: here an edge is.
    const geometry::Vec3 bird{2.0, 2.0, 2.0};
    if (const auto near = bvh::closest_point(tree, roof.view(), bird)) {
        std::cout << "To the bird the corners weigh " << near->weights.x << ", " << near->weights.y
                  << ", " << near->weights.z << "\n";
    }

    for (const auto& near : bvh::closest_triangles(tree, roof.view(), lamp, 2)) {
        std::cout << "Triangle " << near.triangle << " is " << near.distance << " m away\n";
    }

    const geometry::BoxRegion shelf({-1.5, 0.5, -0.5}, {0.0, 1.0, 0.5});
    for (const geometry::TriangleId id : bvh::overlapping(tree, roof.view(), shelf)) {
        std::cout << "The shelf would run into triangle " << id << "\n";
    }
}
