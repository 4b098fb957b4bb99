// SPDX-License-Identifier: MIT
// Arrivals measured in a real room (Di Carlo et al. 2021).
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "support/rooms.h"
#include "support/test_paths.h"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace earshot::support {
namespace {

using geometry::Vec3;

struct Measured {
    int source = 0, microphone = 0;
    Vec3 from{}, to{};
    std::string wall;
    double arrival = 0.0;  // seconds
};

std::vector<Measured> read_measured() {
    std::ifstream file(test::shared_file("reference/dechorate/arrivals.csv"));
    std::vector<Measured> rows;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream words(line);
        Measured row;
        words >> row.source >> row.from.x >> row.from.y >> row.from.z >> row.microphone >>
            row.to.x >> row.to.y >> row.to.z >> row.wall >> row.arrival;
        rows.push_back(row);
    }
    return rows;
}

/// The table is z up; the room's labels are low and high x, y, z.
TEST(Dechorate, MeasuredArrivalsAreWherePathsAre) {
    const auto rows = read_measured();
    if (rows.empty()) {
        GTEST_SKIP() << "reference/dechorate is not there";
    }
    ASSERT_EQ(rows.size(), 840U);
    const std::map<std::string, int> label_of = {{"direct", -1},
                                                 {"west", 0},
                                                 {"east", 1},
                                                 {"south", 2},
                                                 {"north", 3},
                                                 {"floor", 4},
                                                 {"ceiling", 5}};
    const Room room = box_room(Vec3(0.0), {5.705, 5.965, 2.355});
    propagation::Scene scene;
    scene.materials.resize(6);
    scene.material_of_triangle = room.labels;
    scene.mesh = geometry::AnimatedMesh::fixed(room.mesh);
    std::map<int, std::size_t> source_of, listener_of;
    for (const Measured& row : rows) {
        if (source_of.try_emplace(row.source, scene.sources.size()).second) {
            scene.sources.push_back({.name = "s", .node = -1, .position = row.from});
        }
        if (listener_of.try_emplace(row.microphone, scene.listeners.size()).second) {
            scene.listeners.push_back({.name = "l", .node = -1, .position = row.to});
        }
    }
    propagation::Simulator simulator(scene, {.specular_order = 1, .air = {.temperature_c = 24.0}});
    const auto pairs = simulator.run();
    std::vector<double> errors;
    for (const Measured& row : rows) {
        const auto& paths =
            pairs[source_of[row.source] * scene.listeners.size() + listener_of[row.microphone]]
                .paths;
        const int label = label_of.at(row.wall);
        const auto path = std::find_if(paths.begin(), paths.end(), [&](const auto& p) {
            return label < 0 ? p.order == 0
                             : p.order == 1 && p.materials[0] == static_cast<unsigned>(label);
        });
        ASSERT_NE(path, paths.end()) << row.wall;
        errors.push_back(std::abs(path->delay - row.arrival));
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.16e-3);
    EXPECT_LT(errors[errors.size() * 9 / 10], 0.5e-3);
}

}  // namespace
}  // namespace earshot::support
