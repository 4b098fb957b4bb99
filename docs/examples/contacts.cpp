// SPDX-License-Identifier: MIT
#include "earshot/earshot.h"

#include <iostream>

// Whether a door touches its frame while it swings, a thirtieth of a second at a time.
int main() {
    const earshot::Room room = earshot::load("scenes/door.gltf");
    earshot::World world(room);
    constexpr double kStep = 1.0 / 30.0;
    for (double time = 0.0; time < world.duration(); time += kStep) {
        const auto contacts = world.contacts(time, time + kStep);
        if (!contacts.empty()) {
            const auto& first = contacts.front();
            std::cout << world.name_of(first.a.mesh) << " touches " << world.name_of(first.b.mesh)
                      << " after " << time + kStep * first.toi << " s\n";
            return 0;
        }
    }
    std::cout << "nothing touches in " << world.duration() << " s\n";
}
