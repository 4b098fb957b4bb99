// SPDX-License-Identifier: MIT
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include <iostream>

int main() {
    const auto loaded = earshot::io::load_scene("scenes/shoebox.gltf");
    earshot::propagation::Simulator simulator(loaded.scene, {.specular_order = 2});
    for (const auto& pair : simulator.run()) {
        for (const auto& path : pair.paths) {
            std::cout << path.length << " m, " << path.order << " reflections\n";
        }
    }
}
