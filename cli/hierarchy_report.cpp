// SPDX-License-Identifier: MIT
#include "earshot/cli/hierarchy_report.h"

#include "earshot/base/assert.h"
#include "earshot/bvh/quality.h"
#include "earshot/cli/formatted.h"
#include "earshot/cli/output.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace earshot::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Enough for a median that one disturbed run does not move.
constexpr std::size_t kRepetitions = 5;

template <typename Work>
double seconds_of(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

template <typename Work>
double median_seconds_of(Work&& work) {
    std::array<double, kRepetitions> seconds{};
    for (double& value : seconds) {
        value = seconds_of(work);
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds[kRepetitions / 2];
}

}  // namespace

HierarchyReport measure_hierarchy(const propagation::Scene& scene,
                                  std::span<const double> times,
                                  const HierarchyOptions& options,
                                  Executor& executor) {
    EARSHOT_ASSERT(!times.empty());
    HierarchyReport report;
    report.scene = scene.name;
    report.triangles = scene.mesh.triangles().size();
    std::vector<geometry::Vec3> positions = scene.mesh.positions_at(times.front());
    const geometry::MeshView mesh = {positions, scene.mesh.triangles()};
    const auto build = [&] {
        return bvh::Tree::build(bvh::triangle_boxes(mesh, executor), options.build, executor);
    };
    bvh::Tree tree;
    const auto refit = [&] { tree.refit(bvh::triangle_boxes(mesh, executor), executor); };
    report.build_seconds = median_seconds_of([&] { tree = build(); });
    report.refit_seconds = median_seconds_of(refit);
    report.quality = bvh::quality(tree);
    bvh::WideTree wide = bvh::WideTree::build(tree, mesh, executor);
    report.wide_bytes = wide.bytes();
    report.quantised_bytes =
        bvh::WideTree::build(tree, mesh, executor, bvh::LeafEncoding::quantised).bytes();
    if (times.size() == 1) {
        return report;
    }
    bvh::DeformableBvh moving(
        mesh, {.build = options.build, .queries_per_update = options.rays_per_frame}, executor);
    for (const double time : times) {
        scene.mesh.positions_at(time, positions);
        HierarchyFrame frame{.time = time};
        frame.refit_seconds = seconds_of(refit);
        frame.sah_cost = bvh::sah_cost(tree);
        bvh::Tree rebuilt;
        frame.build_seconds = seconds_of([&] { rebuilt = build(); });
        frame.rebuilt_sah_cost = bvh::sah_cost(rebuilt);
        wide.refit(mesh, executor);
        frame.refit_steps = bvh::sah_cost(wide, executor);
        frame.rebuild_steps =
            bvh::sah_cost(bvh::WideTree::build(rebuilt, mesh, executor), executor);
        bvh::UpdateReport update;
        frame.update_seconds = seconds_of([&] { update = moving.update(mesh, executor); });
        frame.update_steps = update.sah_cost;
        frame.action = update.action;
        report.frames.push_back(frame);
    }
    return report;
}

std::string hierarchy_text(const HierarchyReport& report) {
    const auto triangles = static_cast<double>(std::max<std::size_t>(report.triangles, 1));
    const auto memory = [&](const char* what, std::size_t bytes) {
        const auto size = static_cast<double>(bytes);
        return formatted(
            "%s%.2f MiB (%.1f bytes per triangle)\n", what, size / 1048576.0, size / triangles);
    };
    std::string text;
    text += "scene      " + on_one_line(report.scene) + "\n";
    text += formatted("triangles  %zu\n", report.triangles);
    text += formatted("nodes      %zu (%zu leaves)\n", report.quality.nodes, report.quality.leaves);
    text += formatted("depth      %zu\n", report.quality.depth);
    text += formatted("SAH cost   %.2f\n", report.quality.sah_cost);
    text += memory("memory     ", report.quality.bytes);
    text += memory("for rays   ", report.wide_bytes);
    text += memory("quantised  ", report.quantised_bytes);
    text += formatted("build      %.3f ms\n", 1e3 * report.build_seconds);
    text += formatted("refit      %.3f ms\n", 1e3 * report.refit_seconds);
    if (!report.frames.empty()) {
        text +=
            "\n                                                            steps of a random ray\n"
            "    time s  refit ms  build ms  SAH refitted  SAH rebuilt"
            "  refitted  rebuilt  updated by\n";
    }
    for (const HierarchyFrame& frame : report.frames) {
        text += formatted("%10.4f%10.3f%10.3f%14.2f%13.2f%10.2f%9.2f%9.2f %s\n",
                          frame.time,
                          1e3 * frame.refit_seconds,
                          1e3 * frame.build_seconds,
                          frame.sah_cost,
                          frame.rebuilt_sah_cost,
                          frame.refit_steps,
                          frame.rebuild_steps,
                          frame.update_steps,
                          std::string(bvh::name_of(frame.action)).c_str());
    }
    return text;
}

std::string hierarchy_json(const HierarchyReport& report) {
    Json document = {{"version", 1},
                     {"scene", report.scene},
                     {"triangles", report.triangles},
                     {"nodes", report.quality.nodes},
                     {"leaves", report.quality.leaves},
                     {"depth", report.quality.depth},
                     {"sah_cost", report.quality.sah_cost},
                     {"bytes", report.quality.bytes},
                     {"wide_bytes", report.wide_bytes},
                     {"quantised_bytes", report.quantised_bytes},
                     {"build_seconds", report.build_seconds},
                     {"refit_seconds", report.refit_seconds}};
    for (const HierarchyFrame& frame : report.frames) {
        document["frames"].push_back({{"time", frame.time},
                                      {"sah_cost", frame.sah_cost},
                                      {"rebuilt_sah_cost", frame.rebuilt_sah_cost},
                                      {"refit_seconds", frame.refit_seconds},
                                      {"build_seconds", frame.build_seconds},
                                      {"refit_steps", frame.refit_steps},
                                      {"rebuild_steps", frame.rebuild_steps},
                                      {"update_steps", frame.update_steps},
                                      {"action", bvh::name_of(frame.action)},
                                      {"update_seconds", frame.update_seconds}});
    }
    return document.dump(1) + "\n";
}

}  // namespace earshot::cli
