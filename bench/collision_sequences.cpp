// SPDX-License-Identifier: MIT
//
// bench_collision_sequences [THREADS [SEQUENCE]]: time per frame of continuous collision detection,
// with self-collision, in made sequences: a cloth of 92,450 triangles that falls over a ball, ten
// layers of a skirt of 49,920 that swing, and 114 balls of 145,920 that fly about. Processor time
// is that of all threads. Then where it goes: trees that follow the step, search over pairs of
// boxes, tests of elements.

#include "support/collision_sequences.h"

#include "earshot/base/error.h"
#include "earshot/collision/broad_phase/internal/representatives.h"
#include "earshot/collision/broad_phase/internal/swept_broad_phase.h"
#include "earshot/collision/narrow_phase/internal/element_tester.h"
#include "earshot/collision/world.h"

#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace {

using earshot::Executor;
using earshot::collision::ContactOptions;
using earshot::collision::ElementTester;
using earshot::collision::World;
using earshot::collision::WorldStatistics;
using earshot::support::Part;

struct Variant {
    const char* name;
    ContactOptions options;
};

struct Measured {
    double median_ms = 0.0, worst_ms = 0.0, processor_ms = 0.0;
    WorldStatistics sum;
    std::size_t contacts = 0;
};

constexpr int kFrames = 30;

/// Of all threads so far.
double processor_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Measured measure(const std::vector<Part>& parts,
                 const ContactOptions& options,
                 Executor& executor) {
    World world;
    for (const Part& part : parts) {
        world.add_mesh(part.triangles, part.at(0.0).size());
    }
    std::vector<double> times, processor_times;
    Measured measured;
    for (int frame = 0; frame < kFrames; ++frame) {
        for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
            world.update(mesh,
                         parts[mesh].at(frame / double(kFrames)),
                         parts[mesh].at((frame + 1) / double(kFrames)));
        }
        const bench::Times spent =
            bench::times_of([&] { measured.contacts += world.contacts(options, executor).size(); });
        times.push_back(1e3 * spent.clock);
        processor_times.push_back(1e3 * spent.processor);
        measured.sum += world.statistics();
    }
    measured.median_ms = bench::median(times);
    measured.worst_ms = *std::max_element(times.begin(), times.end());
    measured.processor_ms = bench::median(processor_times);
    return measured;
}

void measure(const char* name, const std::vector<Part>& parts, Executor& executor) {
    const std::vector<Variant> variants{
        {"", {.within_meshes = true}},
        {", no front", {.within_meshes = true, .track_front = false}},
        {", no normal cones", {.within_meshes = true, .cull_with_normal_cones = false}},
        {", no representative triangles", {.within_meshes = true, .assign_representatives = false}},
        {", none of these",
         {.within_meshes = true,
          .track_front = false,
          .cull_with_normal_cones = false,
          .assign_representatives = false}}};
    std::size_t triangles = 0;
    for (const Part& part : parts) {
        triangles += part.triangles.size();
    }
    for (const Variant& variant : variants) {
        const Measured measured = measure(parts, variant.options, executor);
        std::printf("| %s%s | %zu | %.0f | %.0f | %.0f | %.3f | %.3f | %.3f | %zu |\n",
                    name,
                    variant.name,
                    triangles,
                    measured.median_ms,
                    measured.worst_ms,
                    measured.processor_ms,
                    1e-6 * static_cast<double>(measured.sum.box_tests) / kFrames,
                    1e-6 * static_cast<double>(measured.sum.triangle_pairs) / kFrames,
                    1e-6 * static_cast<double>(measured.sum.elementary_tests) / kFrames,
                    measured.contacts);
    }
}

/// The tester of a traversal that lists the pairs of triangles instead of testing them.
class PairLister {
public:
    explicit PairLister(const ElementTester& rules) : rules_(&rules) {}

    bool accepts(std::uint32_t a, std::uint32_t b) const { return rules_->accepts(a, b); }
    bool is_contact_free(std::uint32_t node) const { return rules_->is_contact_free(node); }
    bool disjoint_leaves(std::uint32_t a, std::uint32_t b) const {
        return rules_->disjoint_leaves(a, b);
    }
    void test(std::uint32_t slot_a, std::uint32_t slot_b) { pairs.emplace_back(slot_a, slot_b); }

    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;

private:
    const ElementTester* rules_;
};

/// What World::contacts() does on one thread, stage by stage.
void split(const char* name, const std::vector<Part>& parts) {
    using namespace earshot::collision;
    MovingScene scene;
    for (const Part& part : parts) {
        scene.add(part.triangles, part.at(0.0).size());
    }
    const auto representatives = representative_features(scene.triangles);
    const ContactOptions options{.within_meshes = true};
    Executor& executor = Executor::serial();
    SweptBroadPhase broad_phase;
    WorldStatistics statistics;
    std::vector<double> follow, search, test;
    for (int frame = 0; frame < kFrames; ++frame) {
        for (std::size_t i = 0; i < parts.size(); ++i) {
            scene.move(static_cast<std::uint32_t>(i),
                       parts[i].at(frame / double(kFrames)),
                       parts[i].at((frame + 1) / double(kFrames)));
        }
        const double start = processor_ms();
        broad_phase.update(scene, options, executor, statistics);
        const double followed = processor_ms();
        ElementTester tester(scene,
                             broad_phase.swept_bvh(),
                             broad_phase.leaf_slabs(),
                             broad_phase.normal_cones(),
                             representatives,
                             options);
        std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
        broad_phase.traverse(
            options,
            std::numeric_limits<std::size_t>::max(),
            executor,
            statistics,
            [&] { return PairLister(tester); },
            [&](PairLister& lister) {
                pairs.insert(pairs.end(), lister.pairs.begin(), lister.pairs.end());
            });
        const double searched = processor_ms();
        for (const auto& [a, b] : pairs) {
            tester.test(a, b);
        }
        follow.push_back(followed - start);
        search.push_back(searched - followed);
        test.push_back(processor_ms() - searched);
    }
    std::printf("| %s | %.1f | %.1f | %.1f |\n",
                name,
                bench::median(follow),
                bench::median(search),
                bench::median(test));
}

int run(int argc, char** argv) {
    Executor executor(argc > 1 ? std::atoi(argv[1]) : 1);
    const std::string_view wanted = argc > 2 ? argv[2] : "";
    std::vector<std::pair<const char*, std::vector<Part>>> sequences{
        {"cloth on ball", earshot::support::cloth_on_ball(215)},
        {"skirt", earshot::support::skirt(208, 12)},
        {"balls", earshot::support::flying_balls(114, 32, 20)}};
    std::erase_if(sequences, [&](const auto& sequence) {
        return !wanted.empty() && sequence.first != wanted;
    });
    std::printf(
        "%d threads; per frame\n\n| sequence | triangles | median ms | worst ms | processor ms | M "
        "box tests | M pairs | M elementary tests | contacts of all frames |\n| --- | ---: | ---: "
        "| "
        "---: | ---: | ---: | ---: | ---: | ---: |\n",
        executor.threads());
    for (const auto& [name, parts] : sequences) {
        measure(name, parts, executor);
    }
    std::printf(
        "\nOne thread, processor ms\n\n| sequence | trees | search | elements |\n| --- | "
        "---: | ---: | ---: |\n");
    for (const auto& [name, parts] : sequences) {
        split(name, parts);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_collision_sequences", argc, argv, run);
}
