// SPDX-License-Identifier: MIT
//
// bench_view_cells SCENE [CELLS [SEGMENTS [GROUP [THREADS]]]]: the average render cost, in
// triangles, against the number of view cells, for splits by cost, splits in the middle, and cells
// merged from those by cost; once of what the segments saw that the cells were made with, and once
// of what four times as many others see.

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/io/scene_file.h"
#include "earshot/visibility/build_view_cells.h"
#include "earshot/visibility/cell_shape.h"
#include "earshot/visibility/merge_cells.h"
#include "earshot/visibility/sample_free_segments.h"

#include <glm/common.hpp>

#include "harness.h"
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace {

using namespace earshot;
using namespace earshot::visibility;
using geometry::Mesh;

using Sets = std::vector<std::vector<ObjectId>>;

struct Choice {
    std::size_t cells = 512;
    std::size_t segments = 200000;
    std::size_t group = 8;  ///< most triangles of an object
    int threads = 1;
};

void print(const char* what, const bench::Times& times) {
    std::printf("%s: %.2f s, processor %.2f s\n", what, times.clock, times.processor);
}

ViewRegion box_of(const Mesh& mesh) {
    ViewRegion box = {mesh.positions.at(0), mesh.positions.at(0)};
    for (const geometry::Vec3& p : mesh.positions) {
        box.lower = glm::min(box.lower, p);
        box.upper = glm::max(box.upper, p);
    }
    return box;
}

/// What segments see from the leaves that they pass.
Sets seen(const ViewCells& cells, std::span<const FreeSegment> segments, const Objects& objects) {
    std::vector<std::vector<bool>> is_seen(cells.leaves(), std::vector<bool>(objects.size()));
    std::vector<CellId> pierced;
    for (const FreeSegment& free : segments) {
        cells.pierced(shortened(free.segment, plane_slack(cells.region())), pierced);
        for (const CellId cell : pierced) {
            for (const geometry::TriangleId end : {free.at_from, free.at_to}) {
                if (end != kNoTriangle) {
                    is_seen[cell][objects.of(end)] = true;
                }
            }
        }
    }
    Sets sets(cells.leaves());
    for (std::size_t leaf = 0; leaf < sets.size(); ++leaf) {
        for (ObjectId object = 0; object < objects.size(); ++object) {
            if (is_seen[leaf][object]) {
                sets[leaf].push_back(object);
            }
        }
    }
    return sets;
}

/// The partition that there was when it had so many cells.
std::vector<CellId> earlier(const BuiltCells& built, std::size_t cells) {
    std::vector<CellId> cell_of_leaf(built.sets.size());
    for (std::size_t leaf = 0; leaf < cell_of_leaf.size(); ++leaf) {
        cell_of_leaf[leaf] =
            leaf < cells ? static_cast<CellId>(leaf) : cell_of_leaf[built.splits[leaf - 1].leaf];
    }
    return cell_of_leaf;
}

double average_cost(const ViewCells& cells, const Sets& sets, std::span<const double> costs) {
    double sum = 0.0;
    for (std::size_t cell = 0; cell < sets.size(); ++cell) {
        sum += cells.volumes()[cell] / cells.region().volume() * set_cost(sets[cell], costs);
    }
    return sum;
}

double average_cost(const ViewCells& cells,
                    const Sets& leaf_sets,
                    const std::vector<CellId>& cell_of_leaf,
                    std::span<const double> costs) {
    return average_cost(cells.merged(cell_of_leaf), merged_sets(leaf_sets, cell_of_leaf), costs);
}

void add(Digest& digest, const BuiltCells& built) {
    for (const CellNode& node : built.cells.nodes()) {
        digest.add(node.normal);
        digest.add(node.offset);
    }
}

void measure(const Mesh& mesh, const Choice& choice) {
    Executor executor(choice.threads);
    const bvh::DeformableBvh hierarchy(mesh.view());
    const ViewRegion region = box_of(mesh);
    const Objects objects = Objects::groups(mesh.view(), choice.group);
    const auto costs = object_costs(objects);
    std::vector<FreeSegment> segments;
    const bench::Times sampling = bench::times_of([&] {
        segments = sample_free_segments(
            hierarchy.view(), region, {.count = choice.segments, .skip_solids = true}, executor);
    });
    const auto others =
        sample_free_segments(hierarchy.view(),
                             region,
                             {.seed = 2, .count = 4 * choice.segments, .skip_solids = true},
                             executor);
    std::printf("%zu triangles, %zu objects, %zu segments\n",
                mesh.triangles.size(),
                objects.size(),
                segments.size());
    print("sampling", sampling);

    CellOptions options;
    options.max_cells = choice.cells;
    options.mesh = mesh.view();
    BuiltCells by_cost{ViewCells(region)}, by_middle = by_cost;
    print("splits by cost", bench::times_of([&] {
              by_cost = build_view_cells(region, segments, objects, options, executor);
          }));
    options.rule = CellRule::middle;
    print("splits in the middle", bench::times_of([&] {
              by_middle = build_view_cells(region, segments, objects, options, executor);
          }));
    const Sets cost_sets = seen(by_cost.cells, others, objects);
    const Sets middle_sets = seen(by_middle.cells, others, objects);
    std::vector<MergeHistory> histories;
    print("merging", bench::times_of([&] {
              histories.push_back(merge_cells(by_cost.cells, cost_sets, costs, {}, executor));
          }));
    Digest digest;
    add(digest, by_cost);
    for (const CellMerge& merge : histories[0].merges()) {
        digest.add(merge.cost);
    }
    std::printf(
        "digest %016llx\n\n"
        "| cells | by cost | middle | ratio | by cost, others | middle, others | ratio | merged, "
        "others | ratio |\n"
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
        static_cast<unsigned long long>(digest.value()));
    for (std::size_t n = 1; n <= std::min(by_cost.sets.size(), by_middle.sets.size()); n *= 2) {
        const double cost = n == 1 ? by_cost.region_cost : by_cost.splits[n - 2].cost;
        const double middle = n == 1 ? by_middle.region_cost : by_middle.splits[n - 2].cost;
        const double cost_seen = average_cost(by_cost.cells, cost_sets, earlier(by_cost, n), costs);
        const double middle_seen =
            average_cost(by_middle.cells, middle_sets, earlier(by_middle, n), costs);
        const double merged = histories[0].cost_of(n);
        std::printf("| %zu | %.0f | %.0f | %.2f | %.0f | %.0f | %.2f | %.0f | %.2f |\n",
                    n,
                    cost,
                    middle,
                    cost / middle,
                    cost_seen,
                    middle_seen,
                    cost_seen / middle_seen,
                    merged,
                    merged / middle_seen);
    }
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr,
                     "usage: bench_view_cells SCENE [CELLS [SEGMENTS [GROUP [THREADS]]]]\n");
        return 2;
    }
    const auto number = [&](int place, std::size_t otherwise) {
        return argc > place ? std::strtoull(argv[place], nullptr, 10) : otherwise;
    };
    const auto scene = io::load_scene(argv[1]).scene;
    const Choice standard;
    measure({scene.mesh.positions_at(0.0), scene.mesh.triangles()},
            {number(2, standard.cells),
             number(3, standard.segments),
             number(4, standard.group),
             static_cast<int>(number(5, 1))});
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_view_cells", argc, argv, run);
}
