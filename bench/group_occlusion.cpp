// SPDX-License-Identifier: MIT
//
// bench_group_occlusion SCENE [POINTS] [STEPS] [X Y Z]: lines of sight between a source that walks
// and thousands of listeners, decided in groups, beside single tests that remember the last
// occluder and beside a batch of new tests.

#include "earshot/visibility/group_occlusion.h"

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/io/scene_file.h"
#include "earshot/visibility/line_of_sight.h"
#include "earshot/visibility/visibility_matrix.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "harness.h"
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace {

using namespace earshot;
using geometry::Mesh;
using geometry::Segment;
using geometry::TriangleId;
using geometry::Vec3;

constexpr double kStep = 0.07;  // metres: 1.4 m/s at 20 steps a second

struct Extent {
    Vec3 lower{0.0}, upper{0.0};

    Vec3 point(std::uint64_t stream, std::uint64_t index) const {
        Vec3 p;
        for (int k = 0; k < 3; ++k) {
            const double r = random(stream, static_cast<std::uint64_t>(k), index);
            p[k] = lower[k] + r * (upper[k] - lower[k]);
        }
        return p;
    }
};

Extent extent_of(const Mesh& mesh) {
    Extent extent{mesh.positions[0], mesh.positions[0]};
    for (const Vec3& p : mesh.positions) {
        extent.lower = glm::min(extent.lower, p);
        extent.upper = glm::max(extent.upper, p);
    }
    return extent;
}

/// A way at the height of its start, along lines that nothing blocks.
std::vector<Vec3> walk(const bvh::MeshBvh& bvh, const Vec3& start, std::size_t steps) {
    const Mesh ends{{bvh.mesh().positions.begin(), bvh.mesh().positions.end()}, {}};
    const Extent extent = extent_of(ends);
    std::vector<Vec3> way = {start};
    for (std::uint64_t attempt = 0; way.size() < steps && attempt < 1000000; ++attempt) {
        Vec3 target = extent.point(1, attempt);
        target.y = start.y;
        const Vec3 from = way.back();
        const double length = glm::distance(from, target);
        if (length < 4.0 * kStep || !visibility::visible(bvh, {from, target})) {
            continue;
        }
        // Half of the way, so that it stays off the walls.
        for (double along = kStep; along < 0.5 * length && way.size() < steps; along += kStep) {
            way.push_back(from + along / length * (target - from));
        }
    }
    return way;
}

/// Single tests: of the last occluder, and a ray where it does not block any more.
class Memory {
public:
    explicit Memory(std::size_t points) : last_(points, visibility::kNoBlocker) {}

    void ask(const bvh::MeshBvh& bvh,
             const Vec3& source,
             const std::vector<Vec3>& points,
             std::vector<std::uint8_t>& seen) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Segment segment{source, points[i]};
            if (last_[i] != visibility::kNoBlocker) {
                const auto [a, b, c] = bvh.corners(last_[i]);
                if (geometry::touches(segment, a, b, c)) {
                    seen[i] = 0;
                    continue;
                }
            }
            ++rays;
            last_[i] = visibility::kNoBlocker;
            bvh.any_hit(segment, [&](TriangleId id, double) {
                last_[i] = id;
                return true;
            });
            seen[i] = last_[i] == visibility::kNoBlocker ? 1 : 0;
        }
    }

    std::size_t rays = 0;

private:
    std::vector<TriangleId> last_;
};

/// Groups, and a batch of rays to what they leave undecided.
class Groups {
public:
    explicit Groups(const bvh::MeshBvh& bvh) : groups_(bvh.mesh(), {}) {}

    void ask(const bvh::MeshBvh& bvh,
             const Vec3& source,
             const std::vector<Vec3>& points,
             std::vector<std::uint8_t>& seen) {
        groups_.begin_frame(bvh, {}, {&source, 1}, points);
        groups_.visible(0, seen);
        rays += groups_.statistics().rays;
        searches += groups_.statistics().searches;

        shafts += groups_.statistics().shafts;
    }

    std::size_t searches = 0, rays = 0, shafts = 0;

private:
    visibility::GroupOcclusion groups_;
};

/// What the three ways of asking take along the walk.
struct Comparison {
    std::vector<double> batch, memory, groups;  // processor seconds per step
    std::size_t visible = 0, different = 0;     // answers, of all steps
};

Comparison compare(const bvh::MeshBvh& bvh,
                   const std::vector<Vec3>& way,
                   const std::vector<Vec3>& points,
                   Memory& memory,
                   Groups& groups) {
    Comparison comparison;
    std::vector<std::uint8_t> by_batch(points.size()), by_memory(points.size()),
        by_groups(points.size());
    for (const Vec3& source : way) {
        const auto time_of = [](auto&& work) { return bench::times_of(work).processor; };
        comparison.batch.push_back(time_of([&] {
            visibility::visibility_matrix(
                bvh, {{&source, 1}, points}, {}, Executor::serial(), [&](auto row) {
                    std::copy(row.begin(), row.end(), by_batch.begin());
                });
        }));
        comparison.groups.push_back(time_of([&] { groups.ask(bvh, source, points, by_groups); }));
        comparison.memory.push_back(time_of([&] { memory.ask(bvh, source, points, by_memory); }));
        for (std::size_t i = 0; i < points.size(); ++i) {
            comparison.visible += by_batch[i];
            comparison.different +=
                by_batch[i] != by_groups[i] || by_batch[i] != by_memory[i] ? 1 : 0;
        }
    }
    return comparison;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_group_occlusion SCENE [POINTS] [STEPS] [X Y Z]\n");
        return 2;
    }
    const auto scene = io::load_scene(argv[1]).scene;
    const Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    const std::size_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 10000;
    const std::size_t steps = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 240;
    const bvh::DeformableBvh tree(mesh.view());
    const Extent extent = extent_of(mesh);
    const Vec3 start = argc > 6 ? Vec3(std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6]))
                                : 0.5 * (extent.lower + extent.upper);
    const std::vector<Vec3> way = walk(tree.view(), start, steps);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        points.push_back(extent.point(2, i));
    }
    Memory memory(count);
    Groups groups(tree.view());
    const Comparison comparison = compare(tree.view(), way, points, memory, groups);
    const auto per_step = [&](std::size_t n) {
        return static_cast<double>(n) / static_cast<double>(way.size());
    };
    const auto ratio = [&](std::size_t rays) {
        return static_cast<double>(memory.rays) / static_cast<double>(rays);
    };
    std::printf("%s: %zu triangles, %zu points, %zu steps, %.0f visible, %zu answers differ\n\n",
                argv[1],
                mesh.triangles.size(),
                count,
                way.size(),
                per_step(comparison.visible),
                comparison.different);
    std::printf(
        "| rays a step: single tests | groups | ratio | searches | shafts | ratio with both | "
        "ms a step: batch | single tests | groups | batch to groups |\n"
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n"
        "| %.0f | %.0f | %.1f | %.0f | %.0f | %.1f | %.3f | %.3f | %.3f | %.2f |\n",
        per_step(memory.rays),
        per_step(groups.rays),
        ratio(groups.rays),
        per_step(groups.searches),
        per_step(groups.shafts),
        ratio(groups.rays + groups.searches + groups.shafts),
        1e3 * mean(comparison.batch),
        1e3 * mean(comparison.memory),
        1e3 * mean(comparison.groups),
        mean(comparison.batch) / mean(comparison.groups));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_group_occlusion", argc, argv, run);
}
