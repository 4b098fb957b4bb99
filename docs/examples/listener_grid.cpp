// SPDX-License-Identifier: MIT
#include "earshot/frustum/path_finder.h"
#include "earshot/io/scene_file.h"
#include "earshot/propagation/simulator.h"

#include <iostream>
#include <vector>

// Traces a source once and asks for ten thousand listeners: how many ways sound has to the seat
// with most of them, and to that with fewest.
int main() {
    const auto loaded = earshot::io::load_scene("scenes/shoebox.gltf");
    const earshot::propagation::Simulator simulator(loaded.scene);
    const earshot::frustum::PathFinder finder(simulator.scene_view(),
                                              {.trace = {.max_order = 2}, .forward_only = true});
    const auto source = finder.trace_source({1.0, 1.5, -1.0});

    std::vector<earshot::geometry::Vec3> grid;
    for (int i = 0; i < 10000; ++i) {
        grid.emplace_back(0.5 + 0.04 * (i % 100), 1.2, -0.5 - 0.03 * (i / 100));
    }
    std::size_t most = 0, fewest = 1000000;
    finder.for_each_listener(source, grid, [&](std::size_t, const auto& paths) {
        most = std::max(most, paths.size());
        fewest = std::min(fewest, paths.size());
    });
    std::cout << source.frusta() << " frusta, " << grid.size() << " listeners: " << fewest << " to "
              << most << " paths each\n";
}
