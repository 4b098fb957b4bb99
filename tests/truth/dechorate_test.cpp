// SPDX-License-Identifier: MIT
// Arrivals measured in a real room (Di Carlo et al. 2021), and positions from them.
#include "earshot/propagation/least_squares.h"
#include "earshot/propagation/locate.h"
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

/// The room and its loudspeakers and microphones, and the rows as arrivals. The table is z up; the
/// walls are materials of their own.
struct MeasuredRoom {
    propagation::Scene scene;
    std::vector<propagation::MeasuredArrival> arrivals;
};

MeasuredRoom measured_room(const std::vector<Measured>& rows) {
    const Room room = box_room(Vec3(0.0), {5.705, 5.965, 2.355});  // low and high x, y, z
    MeasuredRoom measured;
    propagation::Scene& scene = measured.scene;
    for (const char* wall : {"west", "east", "south", "north", "floor", "ceiling"}) {
        scene.materials.push_back({.name = wall});
    }
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
        using Surfaces = std::vector<std::string>;
        measured.arrivals.push_back(
            {.source = source_of[row.source],
             .listener = listener_of[row.microphone],
             .time = row.arrival,
             .surfaces = row.wall == "direct" ? Surfaces{} : Surfaces{row.wall}});
    }
    return measured;
}

TEST(Dechorate, MeasuredArrivalsAreWherePathsAre) {
    const auto rows = read_measured();
    if (rows.empty()) {
        GTEST_SKIP() << "reference/dechorate is not there";
    }
    ASSERT_EQ(rows.size(), 840U);
    const MeasuredRoom room = measured_room(rows);
    const propagation::Scene& scene = room.scene;
    const auto& arrivals = room.arrivals;
    propagation::Simulator simulator(scene, {.specular_order = 1, .air = {.temperature_c = 24.0}});
    const auto pairs = simulator.run();
    std::vector<double> errors;
    for (const propagation::MeasuredArrival& arrival : arrivals) {
        const auto& paths = pairs[arrival.source * scene.listeners.size() + arrival.listener].paths;
        const auto path = std::find_if(paths.begin(), paths.end(), [&](const auto& p) {
            return p.materials.size() == arrival.surfaces->size() &&
                   (p.order == 0 ||
                    scene.materials[p.materials[0]].name == arrival.surfaces->front());
        });
        ASSERT_NE(path, paths.end());
        errors.push_back(std::abs(path->delay - arrival.time));
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.16e-3);
    EXPECT_LT(errors[errors.size() * 9 / 10], 0.5e-3);
}

/// Positions within the centimetre that they are stated to explain the arrivals better, those too
/// that were not used to find them.
TEST(Dechorate, LocatedPositionsPredictArrivalsThatWereLeftOut) {
    const auto rows = read_measured();
    if (rows.empty()) {
        GTEST_SKIP() << "reference/dechorate is not there";
    }
    if (!propagation::least_squares_available()) {
        GTEST_SKIP() << "built without Ceres' headers";
    }
    const MeasuredRoom room = measured_room(rows);
    const propagation::Scene& scene = room.scene;
    const auto& arrivals = room.arrivals;
    const propagation::LocateOptions options = {
        .source_error = 0.01, .listener_error = 0.01, .air = {.temperature_c = 24.0}};
    const propagation::LocateResult result = propagation::locate(scene, arrivals, options);
    EXPECT_TRUE(result.converged);
    EXPECT_EQ(result.matched, 840U);
    EXPECT_NEAR(result.median_before, 0.150e-3, 0.002e-3);
    EXPECT_LT(result.median_after, 0.065e-3);
    EXPECT_NEAR(result.speed_of_sound.value, 345.8, 0.5);
    for (const propagation::CommonMotion& motion : result.motions) {
        EXPECT_TRUE(motion.is_told_by_data()) << motion.name;
    }
    const auto errors = propagation::cross_validate_locate(scene, arrivals, 5, 1, options);
    EXPECT_LT(*propagation::median_absolute(errors), 0.085e-3);
}

}  // namespace
}  // namespace earshot::support
