// SPDX-License-Identifier: MIT
//
// A cloth falls on a ball. Contacts of each step, of the cloth with the ball and with itself,
// prevent penetration: vertices and edges in contact stay where they were.

#include "earshot/collision/world.h"

#include <cmath>
#include <iostream>
#include <vector>

using namespace earshot;
using geometry::Vec3;

constexpr int kSide = 40;  // squares of the cloth along a side, 5 cm each

geometry::Mesh grid(Vec3 (*position)(double u, double v)) {
    geometry::Mesh mesh;
    for (int i = 0; i <= kSide; ++i) {
        for (int k = 0; k <= kSide; ++k) {
            mesh.positions.push_back(position(double(i) / kSide, double(k) / kSide));
        }
    }
    const auto at = [](int i, int k) { return static_cast<unsigned>(i * (kSide + 1) + k); };
    for (int i = 0; i < kSide; ++i) {
        for (int k = 0; k < kSide; ++k) {
            mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    }
    return mesh;
}

int main() {
    const geometry::Mesh ball = grid([](double u, double v) {
        const double a = 6.283185307179586 * u;
        const double b = 3.141592653589793 * v;
        return 0.5 * Vec3(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a));
    });
    geometry::Mesh cloth =
        grid([](double u, double v) { return Vec3(2.0 * u - 1.0, 0.6, 2.0 * v - 1.0); });

    collision::World world;
    const auto ball_id = world.add_mesh(ball.triangles, ball.positions.size());
    const auto cloth_id = world.add_mesh(cloth.triangles, cloth.positions.size());
    world.update(ball_id, ball.positions, ball.positions);

    // The ball is not tested against itself: its seam touches.
    const collision::ContactOptions options{.within_meshes = true,
                                            .filter = [=](auto, auto b) { return b == cloth_id; }};
    const double step = 1.0 / 60.0;  // seconds
    std::vector<Vec3> speed(cloth.positions.size(), Vec3(0.0));
    for (int frame = 0; frame < 30; ++frame) {
        std::vector<Vec3> next = cloth.positions;
        for (std::size_t v = 0; v < next.size(); ++v) {
            speed[v].y -= 9.81 * step;
            next[v] += step * speed[v];
        }
        world.update(cloth_id, cloth.positions, next);
        // Holding a vertex back changes the motion of its triangles: repeat until there is no
        // contact.
        std::size_t touched = 0;
        for (auto contacts = world.contacts(options); !contacts.empty();
             contacts = world.contacts(options)) {
            touched += contacts.size();
            for (const collision::Contact& contact : contacts) {
                for (const collision::Element& element : {contact.a, contact.b}) {
                    for (std::uint32_t i = 0; element.mesh == cloth_id && i < element.size; ++i) {
                        next[element.vertices[i]] = cloth.positions[element.vertices[i]];
                        speed[element.vertices[i]] = Vec3(0.0);
                    }
                }
            }
            world.update(cloth_id, cloth.positions, next);
        }
        cloth.positions = next;
        if (touched > 0) {
            std::cout << "Frame " << frame << ": " << touched << " contacts\n";
        }
    }
    world.update(cloth_id, cloth.positions, cloth.positions);
    std::cout << "The cloth lies " << 1000.0 * world.distance_at_begin(ball_id, cloth_id).distance
              << " mm above the ball, and goes through nothing: "
              << world.contacts_at_begin(options).size() << " triangles meet\n";
}
