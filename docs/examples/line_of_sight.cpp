// SPDX-License-Identifier: MIT
#include "earshot/earshot.h"

#include <iostream>

// How long a door has to swing until two people on either side of it see each other.
int main() {
    const earshot::Room room = earshot::load("scenes/door.gltf");
    earshot::Sight sight(room);
    for (int tenth = 0; tenth <= 20; ++tenth) {
        sight.set_time(0.1 * tenth);
        if (sight.visible({1.6, 1.5, -1.0}, {1.6, 1.5, 2.0})) {
            std::cout << "visible after " << 0.1 * tenth << " s\n";
            return 0;
        }
    }
    std::cout << "never visible\n";
}
