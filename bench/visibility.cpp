// SPDX-License-Identifier: MIT
//
// bench_visibility MESH [COUNT]: lines of sight per second on one thread beside Embree's
// rtcOccluded in the same run, and between instants of a mesh that is partly moved.

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/io/scene_file.h"
#include "earshot/visibility/coherent_line_of_sight.h"

#include <glm/common.hpp>

#include "bvh_contenders.h"
#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace {

using namespace earshot;
using geometry::Mesh;
using geometry::Segment;
using geometry::Vec3;

constexpr int kRepeats = 5;

class Places {
public:
    explicit Places(const Mesh& mesh) : lower_(mesh.positions[0]), upper_(lower_) {
        for (const Vec3& p : mesh.positions) {
            lower_ = glm::min(lower_, p);
            upper_ = glm::max(upper_, p);
        }
        // A little more than the mesh, because viewers of an object stand outside.
        const Vec3 more = 0.1 * (upper_ - lower_);
        lower_ -= more;
        upper_ += more;
    }

    Vec3 place(std::uint64_t stream, std::uint64_t index) const {
        Vec3 p;
        for (int k = 0; k < 3; ++k) {
            const double r = random(stream, static_cast<std::uint64_t>(k), index);
            p[k] = lower_[k] + r * (upper_[k] - lower_[k]);
        }
        return p;
    }

private:
    Vec3 lower_, upper_;
};

/// From a few points to many, in the order of a matrix; or from anywhere to anywhere.
std::map<std::string, std::vector<Segment>> make_sets(const Mesh& mesh, std::size_t count) {
    const Places places(mesh);
    std::map<std::string, std::vector<Segment>> sets;
    constexpr std::size_t kColumns = 4096;
    for (std::size_t i = 0; i < count; ++i) {
        sets["coherent"].push_back({places.place(1, i / kColumns), places.place(2, i % kColumns)});
        sets["random"].push_back({places.place(3, i), places.place(4, i)});
    }
    return sets;
}

void compare_with_embree(const Mesh& mesh, std::size_t count) {
    const bvh::DeformableBvh hierarchy(mesh.view());
    auto contenders = bench::embree_contenders(1);
    for (auto& contender : contenders) {
        contender->build(mesh.view(), Executor::serial());
    }
    std::printf(
        "| segments | seen, %% | earshot, M/s | fastest of Embree, M/s | which | ratio |\n"
        "| --- | ---: | ---: | ---: | --- | ---: |\n");
    for (const auto& [name, segments] : make_sets(mesh, count)) {
        std::vector<std::vector<double>> times(contenders.size() + 1);
        std::vector<std::uint8_t> seen;
        for (auto& contender : contenders) {
            contender->prepare(segments);
        }
        for (int repeat = 0; repeat < kRepeats; ++repeat) {
            times[0].push_back(
                bench::seconds_of([&] { seen = visibility::visible(hierarchy.view(), segments); }));
            for (std::size_t i = 0; i < contenders.size(); ++i) {
                times[i + 1].push_back(
                    bench::seconds_of([&] { contenders[i]->any(Executor::serial()); }));
            }
        }
        std::size_t best = 0;
        for (std::size_t i = 1; i < contenders.size(); ++i) {
            best = bench::median(times[i + 1]) < bench::median(times[best + 1]) ? i : best;
        }
        const double million = 1e-6 * static_cast<double>(segments.size());
        const double own = million / bench::median(times[0]);
        const double theirs = contenders.empty() ? 0.0 : million / bench::median(times[best + 1]);
        std::printf("| %s | %.1f | %.2f | %.2f | %s | %.2f |\n",
                    name.c_str(),
                    1e-4 / million * static_cast<double>(std::count(seen.begin(), seen.end(), 1)),
                    own,
                    theirs,
                    contenders.empty() ? "none" : contenders[best]->name().c_str(),
                    contenders.empty() ? 0.0 : own / theirs);
    }
}

/// The vertices of one end of the mesh swing; the rest stays.
Mesh swung(const Mesh& mesh, double share, int frame) {
    Mesh moved = mesh;
    std::vector<double> heights;
    for (const Vec3& p : mesh.positions) {
        heights.push_back(p.y);
    }
    const auto place = heights.begin() +
                       static_cast<long>((1.0 - share) * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), place, heights.end());
    const double limit = *place;
    for (Vec3& p : moved.positions) {
        if (p.y > limit) {
            p.x += 0.02 * static_cast<double>(frame % 5) * (p.y - limit);
        }
    }
    return moved;
}

void measure_coherence(const Mesh& mesh, std::size_t count) {
    constexpr int kFrames = 10;
    std::printf(
        "\n| part of the vertices that moves | nodes, coherent | nodes, from scratch | "
        "ratio | ms, coherent | ms, from scratch in batches |\n"
        "| ---: | ---: | ---: | ---: | ---: | ---: |\n");
    const auto segments = make_sets(mesh, count)["coherent"];
    for (const double share : {0.05, 0.2, 1.0}) {
        visibility::CoherentLineOfSight coherent(mesh.view()), counted(mesh.view());
        bvh::DeformableBvh tree(mesh.view());
        counted.collect_statistics(true);
        coherent.visible(mesh.view(), segments);
        counted.visible(mesh.view(), segments);
        std::uint64_t nodes = 0, scratch_nodes = 0;
        double seconds = 0.0, scratch_seconds = 0.0;
        for (int frame = 1; frame <= kFrames; ++frame) {
            const Mesh moved = swung(mesh, share, frame);
            seconds += bench::seconds_of([&] { coherent.visible(moved.view(), segments); });
            scratch_seconds += bench::seconds_of([&] {
                tree.update(moved.view());
                visibility::visible(tree.view(), segments);
            });
            counted.visible(moved.view(), segments);
            nodes += counted.statistics().nodes;
            visibility::CoherentLineOfSight fresh(moved.view());
            fresh.collect_statistics(true);
            fresh.visible(moved.view(), segments);
            scratch_nodes += fresh.statistics().nodes;
        }
        std::printf("| %.0f %% | %.2f M | %.2f M | %.1f | %.1f | %.1f |\n",
                    100.0 * share,
                    1e-6 * static_cast<double>(nodes) / kFrames,
                    1e-6 * static_cast<double>(scratch_nodes) / kFrames,
                    static_cast<double>(scratch_nodes) / static_cast<double>(nodes),
                    1e3 * seconds / kFrames,
                    1e3 * scratch_seconds / kFrames);
    }
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_visibility MESH [COUNT]\n");
        return 2;
    }
    const auto scene = io::load_scene(argv[1]).scene;
    const Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    const std::size_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1000000;
    compare_with_embree(mesh, count);
    measure_coherence(mesh, count / 4);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_visibility", argc, argv, run);
}
