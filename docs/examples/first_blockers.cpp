// SPDX-License-Identifier: MIT
//
// Line of sight: which seats are visible from the stage, what blocks the others, and which become
// visible where glass is looked through.

#include "earshot/bvh/deformable_bvh.h"
#include "earshot/visibility/line_of_sight.h"

#include <iostream>

int main() {
    using namespace earshot;
    // Across the hall at x = 4 stands a wall of 2 m, triangles 0 and 1, under a pane, 2 and 3.
    const geometry::Mesh hall{{{4, 0, 0}, {4, 0, 6}, {4, 2, 6}, {4, 2, 0}, {4, 3, 6}, {4, 3, 0}},
                              {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {3, 4, 5}}};
    const bvh::DeformableBvh hierarchy(hall.view());
    visibility::ExclusionMask glass;
    glass.add(2);
    glass.add(3);

    const geometry::Vec3 stage{0, 1, 4};
    for (const geometry::Vec3& seat : {geometry::Vec3{3, 1, 4}, {6, 1, 4}, {6, 3, 4}, {6, 6, 4}}) {
        const geometry::Segment line{stage, seat};
        std::cout << "Seat " << seat.x << ", " << seat.y << ": ";
        if (const auto blocker = visibility::first_blocker(hierarchy.view(), line)) {
            const bool through_glass = visibility::visible(hierarchy.view(), line, glass);
            std::cout << "behind triangle " << blocker->triangle << " at x = " << 6 * blocker->t
                      << (through_glass ? ", visible through the glass\n" : "\n");
        } else {
            std::cout << "visible\n";
        }
    }
}
