// SPDX-License-Identifier: MIT
//
// bench_bvh: builds, refits and traces a mesh with earshot's hierarchies and, where it was there at
// configure time, with Embree, in one process, in turns, with the same rays.

#include "earshot/base/error.h"
#include "earshot/base/simd.h"
#include "earshot/bvh/builder_names.h"
#include "earshot/io/scene_file.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bvh_contenders.h"
#include "bvh_rays.h"
#include "generated_city.h"
#include "harness.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace {

using namespace bench;
using earshot::geometry::Mesh;

struct Options {
    std::string scene, json, simd = "auto";
    int threads = 1, repeats = 5;
    std::size_t rays = 1U << 20;
    bool from_inside = false;
    std::string builder = "binned_sah";
    int max_leaf_size = 4;
    std::size_t generate = 0;
    std::vector<std::string> sets, only;
};

bool is_wanted(const std::vector<std::string>& list, const std::string& name) {
    return list.empty() || std::any_of(list.begin(), list.end(), [&](const std::string& part) {
               return name.find(part) != std::string::npos;
           });
}

/// Seconds of each run of each contender.
using RunTimes = std::vector<std::vector<double>>;

/// The runs take turns, so that a slow minute slows all of them.
template <typename Run>
RunTimes take_turns(std::size_t contenders, int repeats, Run&& run) {
    RunTimes times(contenders);
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (std::size_t i = 0; i < contenders; ++i) {
            times[i].push_back(run(i));
        }
    }
    return times;
}

std::vector<double> medians(const RunTimes& times) {
    std::vector<double> result;
    for (const auto& of_one : times) {
        result.push_back(bench::median(of_one));
    }
    return result;
}

std::vector<std::unique_ptr<Contender>> all_contenders(const Options& options) {
    auto contenders =
        earshot_contenders({.builder = earshot::bvh::builder_named(options.builder)->builder,
                            .max_leaf_size = options.max_leaf_size});
    for (auto& contender : embree_contenders(options.threads, options.simd)) {
        contenders.push_back(std::move(contender));
    }
    std::erase_if(contenders, [&](const auto& c) { return !is_wanted(options.only, c->name()); });
    return contenders;
}

/// A table with a row per contender and a column per figure, printed and kept for the JSON file.
class Table {
public:
    explicit Table(const std::vector<std::unique_ptr<Contender>>& contenders) {
        for (const auto& contender : contenders) {
            rows_.push_back(contender->name());
        }
    }

    void add(const std::string& column, const std::vector<double>& values) {
        columns_.push_back(column);
        values_.push_back(values);
    }

    /// Seconds, with the runs that they are of.
    void add_times(const std::string& column, const RunTimes& times) {
        add(column, medians(times));
        runs_.push_back(times);
    }

    /// The same of rates.
    void add_rates(const std::string& column, std::size_t rays, const RunTimes& times) {
        std::vector<double> rates;
        for (const double seconds : medians(times)) {
            rates.push_back(1e-6 * static_cast<double>(rays) / seconds);
        }
        add(column, rates);
        runs_.push_back(times);
    }

    void print(const char* title) const {
        std::printf("\n%s\n\n| |", title);
        for (const std::string& column : columns_) {
            std::printf(" %s |", column.c_str());
        }
        std::printf("\n| --- |");
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            std::printf(" ---: |");
        }
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            std::printf("\n| %s |", rows_[i].c_str());
            for (const auto& values : values_) {
                std::printf(values[i] > 0.0 ? " %.4g |" : " |", values[i]);
            }
        }
        std::printf("\n");
    }

    nlohmann::json json() const {
        nlohmann::json result;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            for (std::size_t k = 0; k < columns_.size(); ++k) {
                result[rows_[i]][columns_[k]] = values_[k][i];
            }
        }
        return result;
    }

    /// How many times as fast as another row each is, column by column: the median of the ratios of
    /// neighbouring runs, which a busy machine disturbs less than a ratio of medians.
    void print_ratios(const std::string& reference) const {
        const auto row = std::find(rows_.begin(), rows_.end(), reference);
        if (row == rows_.end()) {
            return;
        }
        const auto at = static_cast<std::size_t>(row - rows_.begin());
        Table ratios = *this;
        // Only the first columns have runs.
        ratios.columns_.resize(runs_.size());
        ratios.values_.resize(runs_.size());
        for (std::size_t column = 0; column < runs_.size(); ++column) {
            for (std::size_t i = 0; i < rows_.size(); ++i) {
                std::vector<double> of_runs;
                for (std::size_t run = 0; run < runs_[column][i].size(); ++run) {
                    of_runs.push_back(runs_[column][at][run] / runs_[column][i][run]);
                }
                ratios.values_[column][i] = bench::median(of_runs);
            }
        }
        ratios.print(("Times as fast as " + reference).c_str());
    }

private:
    std::vector<std::string> rows_, columns_;
    std::vector<std::vector<double>> values_;  // per column, per row
    std::vector<RunTimes> runs_;               // per column, of the first ones
};

/// Of one thread its processor time, which other programs disturb less.
template <typename Run>
double seconds_of_run(const Options& options, Run&& run) {
    const Times times = times_of(run);
    return options.threads == 1 ? times.processor : times.clock;
}

/// Vertices moved a little, so that a refit has something to do.
Mesh shaken(const Mesh& mesh) {
    Mesh moved = mesh;
    for (std::size_t i = 0; i < moved.positions.size(); ++i) {
        moved.positions[i] *= 1.0 + 1e-4 * static_cast<double>(i % 7);
    }
    return moved;
}

Table measure_builds(const Options& options,
                     const Mesh& mesh,
                     std::vector<std::unique_ptr<Contender>>& contenders,
                     earshot::Executor& executor) {
    const std::size_t count = contenders.size();
    Table table(contenders);
    table.add_times("build, s", take_turns(count, options.repeats, [&](std::size_t i) {
                        return seconds_of_run(options,
                                              [&] { contenders[i]->build(mesh.view(), executor); });
                    }));
    std::vector<double> bytes;
    for (const auto& contender : contenders) {
        bytes.push_back(static_cast<double>(contender->bytes()) /
                        static_cast<double>(mesh.triangles.size()));
    }
    table.add("bytes per triangle", bytes);
    const Mesh moved = shaken(mesh);
    table.add("refit, ms", medians(take_turns(count, options.repeats, [&](std::size_t i) {
                  bool has_refit = false;
                  const double seconds = seconds_of_run(
                      options, [&] { has_refit = contenders[i]->refit(moved.view(), executor); });
                  return has_refit ? 1e3 * seconds : 0.0;
              })));
    for (const auto& contender : contenders) {
        contender->build(mesh.view(), executor);
    }
    return table;
}

Table measure_rays(const Options& options,
                   const std::vector<RaySet>& sets,
                   std::vector<std::unique_ptr<Contender>>& contenders,
                   earshot::Executor& executor) {
    Table table(contenders);
    for (const RaySet& set : sets) {
        if (!is_wanted(options.sets, set.name)) {
            continue;
        }
        const bool asks_any = set.rays.empty();
        const std::size_t rays = asks_any ? set.segments.size() : set.rays.size();
        std::vector<std::size_t> hits(contenders.size());
        for (const auto& contender : contenders) {
            asks_any ? contender->prepare(set.segments) : contender->prepare(set.rays);
        }
        const RunTimes times = take_turns(contenders.size(), options.repeats, [&](std::size_t i) {
            return seconds_of_run(options, [&] {
                hits[i] =
                    asks_any ? contenders[i]->any(executor) : contenders[i]->closest(executor);
            });
        });
        std::printf("%s: %zu rays;", set.name.c_str(), rays);
        for (std::size_t i = 0; i < contenders.size(); ++i) {
            std::printf(" %s %zu", contenders[i]->name().c_str(), hits[i]);
            if (const std::uint64_t digest = contenders[i]->digest(); digest != 0) {
                std::printf(" (%016llx)", static_cast<unsigned long long>(digest));
            }
        }
        std::printf("\n");
        table.add_rates(set.name, rays, times);
    }
    return table;
}

Mesh loaded(const std::string& file) {
    const auto scene = earshot::io::load_scene(file, {});
    const auto& mesh = scene.scene.mesh;
    return {mesh.positions_at(0.0), {mesh.triangles().begin(), mesh.triangles().end()}};
}

/// The most memory that this process has had, GiB.
double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

void measure(const Options& options) {
    earshot::override_simd_target(options.simd);
    const Mesh mesh =
        options.generate > 0 ? generated_city(options.generate) : loaded(options.scene);
    earshot::Executor executor(options.threads);
    auto contenders = all_contenders(options);
    std::printf("%s: %zu triangles, %d threads, %s, medians of %d\n",
                options.scene.empty() ? "generated city" : options.scene.c_str(),
                mesh.triangles.size(),
                options.threads,
                earshot::simd_targets().front().c_str(),
                options.repeats);
    const Table builds = measure_builds(options, mesh, contenders, executor);
    builds.print("Building");
    for (const char* reference : {"embree medium", "embree low"}) {
        builds.print_ratios(reference);
    }
    std::printf("\nHits (and digests of answers)\n\n");
    const Table rays = measure_rays(options,
                                    make_ray_sets(mesh.view(), options.rays, options.from_inside),
                                    contenders,
                                    executor);
    rays.print("Million rays per second");
    std::printf("\nAt most %.2f GiB of memory\n", peak_memory());
    for (const char* reference : {"embree medium", "embree robust", "embree high"}) {
        rays.print_ratios(reference);
    }
    if (!options.json.empty()) {
        std::ofstream file(options.json);
        file << nlohmann::json{{"scene", options.scene},
                               {"triangles", mesh.triangles.size()},
                               {"threads", options.threads},
                               {"builds", builds.json()},
                               {"million_rays_per_second", rays.json()}}
                    .dump(2)
             << '\n';
    }
}

std::vector<std::string> builder_names() {
    std::vector<std::string> names;
    for (const auto& builder : earshot::bvh::named_builders()) {
        names.emplace_back(builder.name);
    }
    return names;
}

int run(int argc, char** argv) {
    Options options;
    CLI::App app("Builds, refits and traces a mesh with earshot and Embree");
    app.add_option("SCENE", options.scene, "mesh or glTF scene");
    app.add_option("--generate", options.generate, "a city of so many triangles instead");
    app.add_option("--threads", options.threads, "threads; default: 1");
    app.add_option("--repeats", options.repeats, "runs of each cell; default: 5");
    app.add_option("--rays", options.rays, "rays per set; default: 1048576");
    app.add_flag("--inside", options.from_inside, "the camera stands inside: the mesh is a room");
    app.add_option("--builder", options.builder, "earshot's builder; default: binned_sah")
        ->check(CLI::IsMember(builder_names()));
    app.add_option("--leaf", options.max_leaf_size, "earshot's triangles in a leaf; default: 4");
    app.add_option("--sets", options.sets, "camera, diffuse, ao, random, los; default: all");
    app.add_option("--only", options.only, "contenders whose names contain one of these");
    app.add_option("--simd", options.simd, "instruction set; default: auto");
    app.add_option("--json", options.json, "file for the figures");
    CLI11_PARSE(app, argc, argv);
    if (options.scene.empty() == (options.generate == 0)) {
        std::fprintf(stderr, "bench_bvh: error: give a scene, or --generate and a number\n");
        return 2;
    }
    measure(options);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_bvh", argc, argv, run);
}
