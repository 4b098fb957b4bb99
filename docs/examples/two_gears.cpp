// SPDX-License-Identifier: MIT
//
// Do two gears turn freely? Each rotates once; a contact between them shows where they jam.

#include "earshot/collision/rigid_contacts.h"

#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

using namespace earshot;
using geometry::Vec3;

constexpr double kTurn = 6.283185307179586;

/// The rim of a gear of twelve teeth in the plane y = 0, 10 mm thick: pitch radius 60 mm, teeth 8
/// mm high that taper towards their tips. The first tooth points along `angle`.
geometry::Mesh gear(const Vec3& centre, double angle) {
    constexpr unsigned kTeeth = 12;
    const double pitch = kTurn / kTeeth;
    geometry::Mesh mesh;
    for (unsigned tooth = 0; tooth < kTeeth; ++tooth) {
        const double middle = angle + tooth * pitch;
        for (const auto& [turn, radius] :
             {std::pair(-0.30, 0.056), {-0.10, 0.064}, {0.10, 0.064}, {0.30, 0.056}}) {
            const double a = middle + turn * pitch;
            for (const double y : {-0.005, 0.005}) {
                mesh.positions.push_back(centre +
                                         Vec3(radius * std::cos(a), y, -radius * std::sin(a)));
            }
        }
    }
    const auto corners = static_cast<unsigned>(mesh.positions.size());
    for (unsigned i = 0; i < corners; i += 2) {
        const unsigned next = (i + 2) % corners;
        mesh.triangles.push_back({i, next, next + 1});
        mesh.triangles.push_back({i, next + 1, i + 1});
    }
    return mesh;
}

int main() {
    // A tooth of one points into a gap of the other; the axles are 121 mm apart.
    const Vec3 axle(0.121, 0.0, 0.0);
    const geometry::Mesh left = gear(Vec3(0.0), 0.0);
    const geometry::Mesh right = gear(axle, 0.5 * kTurn + 0.5 * kTurn / 12);
    for (const double ratio : {1.0, 0.98}) {
        const std::vector<collision::MovingBody> gears{
            {left.view(), {.screws = {{.angle = kTurn}}}},
            {right.view(), {.screws = {{.point = axle, .angle = -ratio * kTurn}}}}};
        std::cout << "Driven at a ratio of " << ratio << ": ";
        if (const auto jam = collision::first_contact(gears, {.tolerance = 2e-5})) {
            std::cout << "the gears jam after " << 360.0 * jam->toi
                      << " degrees, at x = " << 1000.0 * jam->point.x << " mm\n";
        } else {
            std::cout << "the gears turn freely\n";
        }
    }
}
