// SPDX-License-Identifier: MIT
//
// A mesh that stands in the world many times: each instance is a matrix, and moving one costs
// nothing per triangle.

#include "earshot/bvh/instances.h"

#include <glm/gtc/matrix_transform.hpp>

#include <iostream>

int main() {
    using namespace earshot;
    // A screen of 2 x 2 metres that faces along x.
    const geometry::Mesh screen{{{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}},
                                {{0, 1, 2}, {0, 2, 3}}};
    bvh::Instances scene;
    const bvh::PartId part = scene.add_part(screen.view());
    for (int i = 0; i < 5; ++i) {
        scene.add_instance(part, glm::translate(glm::dmat4(1.0), {2.0 + i, 0.0, 0.0}));
    }
    scene.update();

    const geometry::Ray ray{{0.0, 0.25, 0.5}, {1.0, 0.0, 0.0}};
    const auto print = [&] {
        if (const auto found = bvh::closest_hit(scene, ray)) {
            std::cout << "screen " << found->instance << ", triangle " << found->hit.triangle
                      << ", at " << found->hit.t << " m\n";
        }
    };
    print();

    scene.remove_instance(0);
    scene.set_transform(3, glm::translate(glm::dmat4(1.0), {2.5, 0.0, 0.0}));
    scene.update();
    print();

    const geometry::Segment view{{0.0, 0.0, 0.0}, {2.4, 0.0, 0.0}};
    std::cout << (bvh::occluded(scene, view) ? "hidden" : "in sight") << "\n";
}
