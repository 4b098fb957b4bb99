// SPDX-License-Identifier: MIT
//
// Is a robot arm's path safe? Three joints move at once; no link may come closer than 2 cm to a
// shelf, at any time and not only at samples of the path.

#include "earshot/collision/rigid_contacts.h"

#include <iostream>
#include <vector>

using namespace earshot;
using geometry::Vec3;

geometry::Mesh box(const Vec3& low, const Vec3& high) {
    geometry::Mesh mesh;
    for (const double x : {low.x, high.x}) {
        for (const double y : {low.y, high.y}) {
            for (const double z : {low.z, high.z}) {
                mesh.positions.emplace_back(x, y, z);
            }
        }
    }
    mesh.triangles = {{0, 1, 3},
                      {0, 3, 2},
                      {4, 6, 7},
                      {4, 7, 5},
                      {0, 4, 5},
                      {0, 5, 1},
                      {2, 3, 7},
                      {2, 7, 6},
                      {0, 2, 6},
                      {0, 6, 4},
                      {1, 5, 7},
                      {1, 7, 3}};
    return mesh;
}

int main() {
    // The arm lies along x: base at the origin, elbow at 0.5 m, wrist at 0.9 m. The base rotates
    // about the vertical axis, elbow and wrist about axes across the arm.
    const geometry::Mesh upper = box({0.0, -0.04, -0.04}, {0.5, 0.04, 0.04});
    const geometry::Mesh lower = box({0.52, -0.03, -0.03}, {0.9, 0.03, 0.03});
    const geometry::Mesh hand = box({0.92, -0.05, -0.02}, {1.05, 0.05, 0.02});
    const geometry::Mesh shelf = box({0.2, 0.45, -0.9}, {0.9, 0.48, -0.3});

    for (const double lift : {0.25, 1.0}) {
        const collision::Screw base{.angle = 1.2};
        const collision::Screw elbow{
            .point = {0.5, 0.0, 0.0}, .axis = {0.0, 0.0, 1.0}, .angle = lift};
        const collision::Screw wrist{
            .point = {0.9, 0.0, 0.0}, .axis = {0.0, 0.0, 1.0}, .angle = lift};
        const std::vector<collision::MovingBody> scene{
            {upper.view(), {.screws = {base}}},
            {lower.view(), {.screws = {base, elbow}}},
            {hand.view(), {.screws = {base, elbow, wrist}}},
            {shelf.view()}};
        const auto contact = collision::first_contact(
            scene,
            {.min_separation = 0.02,
             .tolerance = 1e-3,
             // Links that a joint connects are not tested.
             .filter = [](std::uint32_t a, std::uint32_t b) { return b - a > 1 || b == 3; }});
        std::cout << "Lifting by " << lift << " radians: ";
        if (contact) {
            std::cout << "link " << contact->a.mesh + 1 << " comes within 2 cm of "
                      << (contact->b.mesh == 3 ? "the shelf" : "the arm") << " after "
                      << 100.0 * contact->toi << " % of the way\n";
        } else {
            std::cout << "the path is safe\n";
        }
    }
}
