// SPDX-License-Identifier: MIT
#include "earshot/audio/impulse_response.h"
#include "earshot/base/parallel.h"
#include "earshot/io/results.h"
#include "earshot/propagation/simulator.h"

#include <cstdlib>

// A room of one mirror, from geometry to paths.json: needs every installed library and the packages
// they bring along.
int main() {
    using namespace earshot;
    propagation::Scene scene;
    scene.name = "mirror";
    scene.mesh = geometry::AnimatedMesh::fixed(
        {{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}, {{0, 1, 2}, {0, 2, 3}}});
    scene.materials.resize(1);
    scene.material_of_triangle = {0, 0};
    scene.sources = {{"s", -1, {0, 3, 0}, {}}};
    scene.listeners = {{"l", -1, {8, 3, 0}, {}}};

    Executor executor(2);
    propagation::Simulator simulator(scene, {}, executor);
    const auto pairs = simulator.run(executor);
    const auto& bands = audio::Bands::octaves();
    const auto response = audio::assemble(bands, propagation::arrivals_of(pairs[0]));
    const std::string text =
        io::encode_paths({scene, bands, propagation::speed_of_sound({})}, pairs);
    const bool is_right = pairs[0].paths.size() == 2 && pairs[0].paths[1].length == 10.0 &&
                          !response.samples.empty() && text.size() > 100;
    return is_right ? EXIT_SUCCESS : EXIT_FAILURE;
}
