// SPDX-License-Identifier: MIT
// Listeners that walk from behind obstacles into the open and past the zones of reflections, in
// whole rooms: the metrics that are expected have no step.
#include "earshot/audio/energy_histogram.h"
#include "earshot/audio/energy_metrics.h"
#include "earshot/propagation/simulator.h"

#include <gtest/gtest.h>

#include "support/rooms.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// A hall 44 m long with an obstacle near one end.
Scene hall_with(support::Room obstacle) {
    support::Room room = support::box_room({0, 0, 0}, {44, 6, 12});
    const auto offset = static_cast<geometry::VertexId>(room.mesh.positions.size());
    const std::size_t walls = room.mesh.triangles.size();
    room.mesh.positions.insert(
        room.mesh.positions.end(), obstacle.mesh.positions.begin(), obstacle.mesh.positions.end());
    for (geometry::Triangle triangle : obstacle.mesh.triangles) {
        for (geometry::VertexId& corner : triangle) {
            corner += offset;
        }
        room.mesh.triangles.push_back(triangle);
    }
    Scene scene;
    scene.name = "hall";
    scene.materials.resize(2);
    scene.materials[0].name = "walls";
    scene.materials[0].absorption = EnergyCoefficient(0.3);
    scene.materials[1].name = "obstacle";
    scene.materials[1].absorption = EnergyCoefficient(0.15);
    scene.material_of_triangle.assign(room.mesh.triangles.size(), 1);
    std::fill_n(scene.material_of_triangle.begin(), walls, 0U);
    scene.sources = {{.name = "s", .node = -1, .position = {4.1, 1.4, 6.2}}};
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(room.mesh));
    return scene;
}

/// With plates, each given by its corners.
Scene hall_with_plates(const std::vector<std::vector<Vec3>>& plates) {
    support::Room room;
    for (const std::vector<Vec3>& corners : plates) {
        support::add_polygon(room, corners, 0);
    }
    return hall_with(room);
}

Scene hall_with_screen() {
    return hall_with_plates({{Vec3(6, 0.4, 5), Vec3(6, 0.4, 7), Vec3(6, 2.2, 7), Vec3(6, 2.2, 5)}});
}

/// An L-shaped room, whose corner stands between the source and one end.
Scene room_with_corner() {
    support::Room room = support::plan_room(std::array{glm::dvec2(0, 0),
                                                       glm::dvec2(9, 0),
                                                       glm::dvec2(9, 9),
                                                       glm::dvec2(4, 9),
                                                       glm::dvec2(4, 5),
                                                       glm::dvec2(0, 5)},
                                            3.0);
    Scene scene = hall_with_screen();
    scene.name = "corner";
    scene.material_of_triangle.assign(room.mesh.triangles.size(), 0);
    scene.sources[0].position = {7.1, 1.4, -7.9};
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(room.mesh));
    return scene;
}

/// A barrier 1 m thick, whose top is the plane y = 0, in the open.
Scene barrier() {
    support::Room room;
    support::add_hexahedron(
        room, support::box_corners({-0.5, -9, -9}, {0.5, 0, 9}), support::Facing::outward, 0);
    Scene scene;
    scene.name = "barrier";
    scene.materials.resize(1);
    scene.materials[0].name = "barrier";
    scene.materials[0].absorption = EnergyCoefficient(0.15);
    scene.material_of_triangle.assign(room.mesh.triangles.size(), 0);
    scene.sources = {{.name = "s", .node = -1, .position = {-3.5, -1.5, 0.0}}};
    scene.mesh = geometry::AnimatedMesh::fixed(std::move(room.mesh));
    return scene;
}

/// The same everywhere: sound that decays by 60 dB in 1.4 s.
audio::EnergyHistogram late_sound() {
    constexpr double kBin = 1e-3;
    audio::EnergyHistogram late{.bin = kBin, .energy = std::vector<audio::Spectrum>(2000)};
    for (std::size_t i = 20; i < late.energy.size(); ++i) {
        late.energy[i].fill(1e-4 * std::exp(-kBin * static_cast<double>(i) / 0.1));
    }
    late.full_decay = true;
    return late;
}

/// G at 125 Hz and 1 kHz, C80 at 1 kHz, and STI.
using Metrics = std::array<double, 4>;

/// Of a change of place that is small against all waves. Metrics read times on a grid of a tenth of
/// a millisecond: an onset that moves by one of its steps changes C80 by 0.005 dB here. In the bass
/// an onset may move by more: it is the first energy less than 20 dB below the largest.
constexpr Metrics kMaxSteps{0.003, 0.003, 0.012, 0.001};

class Walk {
public:
    Walk(Scene scene, const Vec3& from, const Vec3& to, int order = 1, int diffraction = 1)
        : scene_(std::move(scene)),
          from_(from),
          to_(to),
          options_{.specular_order = order,
                   .diffraction = diffraction,
                   .min_diffraction_level_db = -std::numeric_limits<double>::infinity(),
                   .air_absorption = false} {}

    /// Metrics at places from `begin` to `end`, shares of the way.
    std::vector<Metrics> between(double begin, double end, int steps) {
        scene_.listeners.clear();
        for (int i = 0; i <= steps; ++i) {
            const double t = begin + (end - begin) * i / steps;
            scene_.listeners.push_back(
                {.name = std::to_string(i), .node = -1, .position = from_ + t * (to_ - from_)});
        }
        Simulator simulator(scene_, options_);
        std::vector<Metrics> metrics;
        for (const PairResult& pair : simulator.run()) {
            const audio::RoomMetrics found =
                audio::energy_metrics(audio::Bands::octaves(), energy_arrivals_of(pair), late_);
            constexpr std::size_t kBass = 2, kKilohertz = 5;
            metrics.push_back({found.bands[kBass].strength_db.value(),
                               found.bands[kKilohertz].strength_db.value(),
                               found.bands[kKilohertz].clarity_c80_db.value(),
                               found.speech_transmission_index.value()});
            paths_.push_back(0);
            for (const Path& path : pair.paths) {
                paths_.back() += path.kind != PathKind::diffracted ? 1 : 0;
            }
        }
        return metrics;
    }
    /// Of specular paths, at all places asked for.
    const std::vector<int>& paths() const { return paths_; }

private:
    Scene scene_;
    Vec3 from_, to_;
    Options options_;
    audio::EnergyHistogram late_ = late_sound();
    std::vector<int> paths_;
};

// The largest step of each metric is looked at ever closer: of a smooth curve it becomes as small
// as the step of the walk, of a jump it stays.
void expect_continuous(Walk walk) {
    constexpr int kSteps = 40;
    const std::vector<Metrics> coarse = walk.between(0.0, 1.0, kSteps);
    EXPECT_NE(*std::min_element(walk.paths().begin(), walk.paths().end()),
              *std::max_element(walk.paths().begin(), walk.paths().end()));
    for (std::size_t metric = 0; metric < coarse.front().size(); ++metric) {
        double begin = 0.0, end = 1.0;
        std::vector<Metrics> values = coarse;
        double largest = 0.0;
        for (int level = 0; level < 4; ++level) {
            largest = 0.0;
            std::size_t place = 0;
            for (std::size_t i = 0; i + 1 < values.size(); ++i) {
                const double step = std::abs(values[i + 1][metric] - values[i][metric]);
                if (step > largest) {
                    largest = step;
                    place = i;
                }
            }
            const double size = (end - begin) / static_cast<double>(values.size() - 1);
            begin += static_cast<double>(place) * size;
            end = begin + size;
            values = walk.between(begin, end, 8);
        }
        EXPECT_LT(largest, kMaxSteps[metric])
            << "metric " << metric << " at " << begin << " of the way";
    }
}

TEST(DiffractionSweep, MetricsAreContinuousRoundAScreen) {
    // Past its side, over its top, along the zones of reflections behind and before it.
    expect_continuous({hall_with_screen(), {8.0, 1.3, 6.0}, {8.4, 1.5, 10.0}});
    expect_continuous({hall_with_screen(), {7.0, 1.0, 6.1}, {7.5, 4.5, 6.3}});
    expect_continuous({hall_with_screen(), {9.0, 0.4, 6.0}, {7.0, 1.8, 2.0}});
    expect_continuous({hall_with_screen(), {5.0, 1.5, 6.0}, {4.5, 1.6, 10.5}});
}

// Six more geometries, in which no listener or image of one crosses the plane of a plate beside it.
TEST(SlowDiffractionSweep, MetricsAreContinuousPastOtherShapes) {
    const auto plates = [](std::vector<std::vector<Vec3>> corners) {
        return hall_with_plates(corners);
    };
    // A triangle, a screen on the floor, half a wall, a gap between two walls, a reflector
    // overhead, and a corner.
    expect_continuous({plates({{Vec3(6, 0.5, 5), Vec3(6, 0.5, 7.3), Vec3(6, 2.6, 6.1)}}),
                       {8.0, 1.3, 5.0},
                       {7.0, 1.6, 9.0}});
    expect_continuous(
        {plates({{Vec3(6, 0, 5), Vec3(6, 0, 7.2), Vec3(6, 1.8, 7.2), Vec3(6, 1.8, 5)}}),
         {7.5, 0.8, 6.0},
         {8.2, 4.0, 6.3}});
    expect_continuous({plates({{Vec3(6, 0, 0), Vec3(6, 0, 7), Vec3(6, 6, 7), Vec3(6, 6, 0)}}),
                       {8.0, 1.3, 6.0},
                       {8.4, 1.5, 10.0}});
    expect_continuous({plates({{Vec3(6, 0, 0), Vec3(6, 0, 5.8), Vec3(6, 6, 5.8), Vec3(6, 6, 0)},
                               {Vec3(6, 0, 7), Vec3(6, 0, 12), Vec3(6, 6, 12), Vec3(6, 6, 7)}}),
                       {8.0, 1.3, 4.0},
                       {8.4, 1.5, 8.5}});
    expect_continuous({plates({{Vec3(5, 4.5, 5),
                                Vec3(7, 4.5, 5),
                                Vec3(7.5, 4.5, 6),
                                Vec3(7, 4.5, 7.1),
                                Vec3(5, 4.5, 7.1),
                                Vec3(4.5, 4.5, 6)}}),
                       {7.5, 1.3, 6.0},
                       {12.0, 1.5, 7.0}});
    expect_continuous({room_with_corner(), {1.0, 1.3, -3.0}, {3.6, 1.5, -1.0}});
}

// When a listener crosses the plane of the top, the path over the near edge is cut by the far one,
// and that over both takes its place. What is left is that of three edges.
TEST(DiffractionSweep, SecondOrderTakesThePlaceOfAPathThatIsCut) {
    const Vec3 below(3.5, -1e-6, 0.3), above(3.5, 1e-6, 0.3);
    for (const int diffraction : {1, 2}) {
        const auto steps = Walk(barrier(), below, above, 1, diffraction).between(0.0, 1.0, 1);
        for (std::size_t metric = 0; metric < 2; ++metric) {  // G
            const double step = std::abs(steps[1][metric] - steps[0][metric]);
            if (diffraction == 1) {
                EXPECT_GT(step, 0.5);
            } else {
                EXPECT_LT(step, 0.05);
            }
        }
    }
}

}  // namespace
}  // namespace earshot::propagation
