// SPDX-License-Identifier: MIT
//
// bench_collision_sequences [THREADS]: time per frame of continuous collision detection, with
// self-collision, in made sequences: a cloth of 92,450 triangles that falls over a ball, ten layers
// of a skirt of 49,920 that swing, and 114 balls of 145,920 that fly about.

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/collision/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <vector>

namespace {

using earshot::Executor;
using earshot::collision::World;
using earshot::geometry::Triangle;
using earshot::geometry::Vec3;
using earshot::geometry::VertexId;

/// A grid of quadrilaterals as triangles; wraps round its first direction if asked.
std::vector<Triangle> grid(int columns, int rows, bool wraps) {
    std::vector<Triangle> triangles;
    const int per_row = wraps ? columns : columns + 1;
    const auto at = [&](int i, int k) {
        return static_cast<VertexId>(k * per_row + (wraps ? i % columns : i));
    };
    for (int k = 0; k < rows; ++k) {
        for (int i = 0; i < columns; ++i) {
            triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    }
    return triangles;
}

struct Part {
    std::vector<Triangle> triangles;
    std::function<std::vector<Vec3>(double)> at;  // positions at a time, 0 ... 1
};

/// Falls from above a ball of radius 0.3 and lies on it in folds that turn.
Part cloth() {
    constexpr int kSide = 215;
    return {grid(kSide, kSide, false), [](double t) {
                std::vector<Vec3> points;
                for (int k = 0; k <= kSide; ++k) {
                    for (int i = 0; i <= kSide; ++i) {
                        const double x = 2.0 * i / kSide - 1.0;
                        const double z = 2.0 * k / kSide - 1.0;
                        const double r = std::sqrt(x * x + z * z);
                        const double fold =
                            0.12 * t * r * std::cos(12.0 * std::atan2(z, x) + 3.0 * t);
                        const double pull = 1.0 - 0.45 * t * std::min(1.0, r);
                        const double height = 0.32 - t * std::max(0.0, r - 0.25) * 0.9 + fold;
                        points.emplace_back(x * pull, height, z * pull);
                    }
                }
                return points;
            }};
}

Part ball(const Vec3& from, const Vec3& velocity, double radius, int columns, int rows) {
    return {grid(columns, rows, true), [=](double t) {
                std::vector<Vec3> points;
                for (int k = 0; k <= rows; ++k) {
                    const double polar = 3.14159265358979 * (0.01 + 0.98 * k / rows);
                    for (int i = 0; i < columns; ++i) {
                        const double turn = 6.28318530717959 * i / columns;
                        points.push_back(from + t * velocity +
                                         radius * Vec3(std::sin(polar) * std::cos(turn),
                                                       std::cos(polar),
                                                       std::sin(polar) * std::sin(turn)));
                    }
                }
                return points;
            }};
}

/// A layer of a skirt, 4 mm from the next, with waves that travel.
Part skirt(int layer) {
    constexpr int kColumns = 208;
    constexpr int kRows = 12;
    return {grid(kColumns, kRows, true), [layer](double t) {
                std::vector<Vec3> points;
                for (int k = 0; k <= kRows; ++k) {
                    for (int i = 0; i < kColumns; ++i) {
                        const double turn = 6.28318530717959 * i / kColumns;
                        const double down = k / double(kRows);
                        const double r = 0.2 + 0.004 * layer + 0.5 * down +
                                         0.05 * down * std::sin(9.0 * turn + 6.0 * t);
                        points.emplace_back(r * std::cos(turn + 0.2 * t * down),
                                            -down + 0.02 * std::sin(5.0 * turn - 4.0 * t),
                                            r * std::sin(turn + 0.2 * t * down));
                    }
                }
                return points;
            }};
}

void measure(const char* name, const std::vector<Part>& parts, Executor& executor) {
    constexpr int kFrames = 30;
    World world;
    std::size_t triangles = 0;
    for (const Part& part : parts) {
        world.add_mesh(part.triangles, part.at(0.0).size());
        triangles += part.triangles.size();
    }
    std::vector<double> times;
    std::size_t contacts = 0;
    earshot::collision::WorldStatistics sum;
    for (int frame = 0; frame < kFrames; ++frame) {
        for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
            world.update(mesh,
                         parts[mesh].at(frame / double(kFrames)),
                         parts[mesh].at((frame + 1) / double(kFrames)));
        }
        const auto start = std::chrono::steady_clock::now();
        contacts += world.contacts({.within_meshes = true}, executor).size();
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        times.push_back(1e3 * elapsed.count());
        sum.box_tests += world.statistics().box_tests;
        sum.triangle_pairs += world.statistics().triangle_pairs;
        sum.elementary_tests += world.statistics().elementary_tests;
    }
    std::sort(times.begin(), times.end());
    std::printf("| %s | %zu | %.0f | %.0f | %.2f | %.2f | %.2f | %.0f |\n",
                name,
                triangles,
                times[kFrames / 2],
                times.back(),
                1e-6 * static_cast<double>(sum.box_tests) / kFrames,
                1e-6 * static_cast<double>(sum.triangle_pairs) / kFrames,
                1e-6 * static_cast<double>(sum.elementary_tests) / kFrames,
                static_cast<double>(contacts) / kFrames);
}

int run(int argc, char** argv) {
    Executor executor(argc > 1 ? std::atoi(argv[1]) : 1);
    std::printf(
        "%d threads\n\n| sequence | triangles | median ms | worst ms | M box tests | M pairs | "
        "M elementary tests | contacts |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | "
        "---: |\n",
        executor.threads());
    measure("cloth on ball", {cloth(), ball({0, 0, 0}, {0, 0, 0}, 0.3, 48, 24)}, executor);
    std::vector<Part> layers;
    for (int layer = 0; layer < 10; ++layer) {
        layers.push_back(skirt(layer));
    }
    measure("skirt", layers, executor);
    std::vector<Part> balls;
    for (std::uint64_t i = 0; i < 114; ++i) {
        const auto dice = [&](std::uint64_t k) { return earshot::random_between(1, k, i, -1, 1); };
        balls.push_back(
            ball({dice(0), dice(1), dice(2)}, {dice(3), dice(4), dice(5)}, 0.12, 32, 20));
    }
    measure("balls", balls, executor);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const earshot::Error& error) {
        std::fprintf(stderr, "bench_collision_sequences: %s\n", error.line().c_str());
        return 1;
    }
}
