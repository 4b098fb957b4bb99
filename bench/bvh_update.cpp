// SPDX-License-Identifier: MIT
//
// bench_bvh_update [MESH [RAYS]]: what it costs to keep a hierarchy over a mesh that deforms, and
// to query it, for four policies: refit only, rebuild always, the 40 % rule of Lauterbach 2010, and
// DeformableBvh; and what reinsertion gains in the mesh at rest. Without a mesh: in a city through
// which boxes drift. Processor times, so that other programs disturb less.

#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/bvh/partial_refit.h"
#include "earshot/bvh/quality.h"
#include "earshot/bvh/reinsertion.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/io/scene_file.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "harness.h"
#include "structures/area_ratio_rule.h"
#include "support/drifting_city.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using bench::AreaRatioRule;
using earshot::random;
using earshot::bvh::DeformableBvh;
using earshot::bvh::Tree;
using earshot::bvh::WideTree;
using earshot::geometry::Hit;
using earshot::geometry::Mesh;
using earshot::geometry::MeshView;
using earshot::geometry::Ray;
using earshot::geometry::Vec3;

struct Box {
    Vec3 lower{1e300}, upper{-1e300};
    double diagonal() const { return glm::length(upper - lower); }
};

Box box_of(const Mesh& mesh) {
    Box box;
    for (const Vec3& position : mesh.positions) {
        box.lower = glm::min(box.lower, position);
        box.upper = glm::max(box.upper, position);
    }
    return box;
}

/// The mesh with vertices that no two triangles share.
Mesh unshared(const Mesh& mesh) {
    Mesh result;
    for (const auto& triangle : mesh.triangles) {
        const auto first = static_cast<earshot::geometry::VertexId>(result.positions.size());
        for (const auto vertex : triangle) {
            result.positions.push_back(mesh.positions[vertex]);
        }
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

template <typename Work>
double processor_seconds_of(Work&& work) {
    return bench::times_of(work).processor;
}

using Motion = std::function<Mesh(double)>;  // of time, 0 to 1

/// A wave runs through the mesh.
Motion wave(const Mesh& mesh) {
    const double size = box_of(mesh).diagonal();
    return [=](double time) {
        Mesh moved = mesh;
        for (Vec3& p : moved.positions) {
            p.y += 0.05 * size * std::sin(20.0 * p.x / size + 6.0 * time);
        }
        return moved;
    };
}

/// Cells of the mesh, `cells` along the diagonal, drift apart by half of it; with none, every
/// triangle goes its own way.
Motion drift(const Mesh& shared, double cells) {
    const Mesh mesh = unshared(shared);
    const Box box = box_of(mesh);
    return [=](double time) {
        Mesh moved = mesh;
        for (std::size_t i = 0; i < moved.triangles.size(); ++i) {
            const Vec3 place =
                glm::floor(cells / box.diagonal() * (moved.positions[3 * i] - box.lower));
            const auto part =
                cells > 0.0 ? static_cast<std::uint64_t>(place.x + 1000.0 * place.y + 1e6 * place.z)
                            : i;
            const Vec3 way(random(1, part, 0), random(1, part, 1), random(1, part, 2));
            for (std::size_t k = 0; k < 3; ++k) {
                moved.positions[3 * i + k] += time * box.diagonal() * (way - 0.5);
            }
        }
        return moved;
    };
}

std::vector<Ray> random_rays(const Mesh& mesh, std::uint64_t frame, std::size_t count) {
    const Box box = box_of(mesh);
    std::vector<Ray> rays(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto dice = [&](std::uint64_t stream) { return random(frame, stream, i); };
        const double z = 1.0 - 2.0 * dice(3);
        const double r = std::sqrt(1.0 - z * z);
        const double angle = 6.283185307179586 * dice(4);
        rays[i] = {box.lower + (box.upper - box.lower) * Vec3(dice(0), dice(1), dice(2)),
                   {r * std::cos(angle), r * std::sin(angle), z}};
    }
    return rays;
}

/// A way to keep a tree.
struct Policy {
    const char* name;
    std::function<void(const MeshView&)> update;
    std::function<const WideTree&()> tree;
    double update_seconds = 0.0, ray_seconds = 0.0, worst_rate = 1e300;
    double last_cost = 0.0;  // sah_cost() in the last frame
    std::vector<std::optional<Hit>> hits{};
};

WideTree built(const MeshView& mesh) {
    return WideTree::build(Tree::build(earshot::bvh::triangle_boxes(mesh)), mesh);
}

void follow(const char* name, const Motion& motion, int frames, std::size_t ray_count) {
    const Mesh rest = motion(0.0);
    WideTree refitted = built(rest.view());
    WideTree rebuilt = refitted;
    DeformableBvh moving(rest.view(), {.queries_per_update = static_cast<double>(ray_count)});
    Tree by_rule = Tree::build(earshot::bvh::triangle_boxes(rest.view()));
    WideTree by_rule_wide = refitted;
    auto rule = std::make_unique<AreaRatioRule>(by_rule);
    int rule_rebuilds = 0, repairs = 0, rebuilds = 0;
    std::vector<Policy> policies = {
        {"rebuild always",
         [&](const MeshView& mesh) { rebuilt = built(mesh); },
         [&]() -> const WideTree& { return rebuilt; }},
        {"refit only",
         [&](const MeshView& mesh) { refitted.refit(mesh); },
         [&]() -> const WideTree& { return refitted; }},
        {"40 % rule",
         [&](const MeshView& mesh) {
             by_rule.refit(earshot::bvh::triangle_boxes(mesh));
             if (rule->growth(by_rule) <= AreaRatioRule::kThreshold) {
                 by_rule_wide.refit(mesh);
                 return;
             }
             by_rule = Tree::build(earshot::bvh::triangle_boxes(mesh));
             rule = std::make_unique<AreaRatioRule>(by_rule);
             by_rule_wide = WideTree::build(by_rule, mesh);
             ++rule_rebuilds;
         },
         [&]() -> const WideTree& { return by_rule_wide; }},
        {"update",
         [&](const MeshView& mesh) {
             const auto action = moving.update(mesh).action;
             repairs += action == earshot::bvh::UpdateAction::repair ? 1 : 0;
             rebuilds += action == earshot::bvh::UpdateAction::rebuild ? 1 : 0;
         },
         [&]() -> const WideTree& { return moving.tree(); }}};
    for (int frame = 1; frame <= frames; ++frame) {
        const Mesh mesh = motion(static_cast<double>(frame) / frames);
        const auto rays = random_rays(mesh, static_cast<std::uint64_t>(frame), ray_count);
        double fresh = 0.0;
        for (Policy& policy : policies) {
            policy.hits.resize(ray_count);
            policy.update_seconds += processor_seconds_of([&] { policy.update(mesh.view()); });
            const double asked = processor_seconds_of(
                [&] { earshot::bvh::closest_hits(policy.tree(), mesh.view(), rays, policy.hits); });
            policy.last_cost = earshot::bvh::sah_cost(policy.tree());
            policy.ray_seconds += asked;
            fresh = fresh == 0.0 ? asked : fresh;
            policy.worst_rate = std::min(policy.worst_rate, fresh / asked);
            if (policy.hits != policies.front().hits) {
                std::printf("%s: answers differ in frame %d\n", policy.name, frame);
            }
        }
    }
    for (const Policy& policy : policies) {
        std::printf("| %s | %s | %.2f | %.1f | %.1f | %.2f | %.2f | %.2f |\n",
                    name,
                    policy.name,
                    1e3 * policy.update_seconds / frames,
                    1e3 * policy.ray_seconds / frames,
                    1e3 * (policy.update_seconds + policy.ray_seconds) / frames,
                    policies.front().ray_seconds / policy.ray_seconds,
                    policy.worst_rate,
                    policy.last_cost / policies.front().last_cost);
    }
    std::printf("| | 40 %% rule: %d rebuilds; update: %d repairs, %d rebuilds | | | | | | |\n",
                rule_rebuilds,
                repairs,
                rebuilds);
}

/// A hundred copies of the mesh, of which one moves.
void move_one_of_a_hundred(const Mesh& part) {
    Mesh mesh;
    const double size = box_of(part).diagonal();
    for (int copy = 0; copy < 100; ++copy) {
        const auto first = static_cast<earshot::geometry::VertexId>(mesh.positions.size());
        for (const Vec3& p : part.positions) {
            mesh.positions.push_back(p + size * Vec3(copy % 10, 0.0, copy / 10));
        }
        for (const auto& t : part.triangles) {
            mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
    }
    WideTree tree = built(mesh.view());
    earshot::bvh::PartialRefit places(tree);
    const auto count = static_cast<std::uint32_t>(part.triangles.size());
    const std::vector<earshot::bvh::TriangleRange> one = {{42 * count, 43 * count}};
    double full = 1e300, partial = 1e300;
    for (int repeat = 0; repeat < 5; ++repeat) {
        for (std::size_t i = 0; i < part.positions.size(); ++i) {
            mesh.positions[42 * part.positions.size() + i].y += 0.01 * size;
        }
        partial =
            std::min(partial, bench::seconds_of([&] { places.refit(tree, mesh.view(), one); }));
        full = std::min(full, bench::seconds_of([&] { tree.refit(mesh.view()); }));
    }
    std::printf("\nOne of 100 parts moves, %zu triangles: %.3f ms, %.2f %% of a full refit\n",
                mesh.triangles.size(),
                1e3 * partial,
                100.0 * partial / full);
}

/// Nodes of the binary tree that a random segment visits until it is known to be free or not.
double visits_per_segment(const Tree& tree, const Mesh& mesh) {
    constexpr std::uint64_t kSegments = 20000;
    const Box box = box_of(mesh);
    const auto point = [&](std::uint64_t stream, std::uint64_t i) {
        return box.lower + (box.upper - box.lower) * Vec3(random(1, stream, i),
                                                          random(1, stream + 1, i),
                                                          random(1, stream + 2, i));
    };
    std::uint64_t visits = 0;
    for (std::uint64_t i = 0; i < kSegments; ++i) {
        const Vec3 from = point(0, i), way = point(3, i) - from;
        std::vector<std::uint32_t> stack = {0};
        while (!stack.empty()) {
            const earshot::bvh::Node& node = tree.nodes()[stack.back()];
            stack.pop_back();
            double enter = 0.0, leave = 1.0;
            for (int axis = 0; axis < 3; ++axis) {
                const auto k = static_cast<std::size_t>(axis);
                const double a = (static_cast<double>(node.box.lower[k]) - from[axis]) / way[axis];
                const double b = (static_cast<double>(node.box.upper[k]) - from[axis]) / way[axis];
                enter = std::max(enter, std::min(a, b));
                leave = std::min(leave, std::max(a, b));
            }
            if (enter <= leave) {
                ++visits;
                if (!node.is_leaf()) {
                    stack.push_back(node.first + 1);
                    stack.push_back(node.first);
                }
            }
        }
    }
    return static_cast<double>(visits) / kSegments;
}

/// What reinsertion gains in a new tree.
void reinsert(const Mesh& mesh) {
    Tree tree = Tree::build(earshot::bvh::triangle_boxes(mesh.view()));
    const double visits = visits_per_segment(tree, mesh);
    earshot::bvh::ReinsertionReport report;
    const double seconds =
        processor_seconds_of([&] { report = earshot::bvh::optimise_by_reinsertion(tree); });
    std::printf(
        "Reinsertion: SAH cost %.2f to %.2f, nodes on a random segment %.2f to %.2f, "
        "%zu reinsertions in %.1f ms\n\n",
        report.sah_cost_before,
        report.sah_cost_after,
        visits,
        visits_per_segment(tree, mesh),
        report.reinsertions,
        1e3 * seconds);
}

void print_heading(const char* name, std::size_t triangles, int frames, std::size_t rays) {
    std::printf("%s: %zu triangles, %d frames, %zu random rays a frame, one thread\n\n",
                name,
                triangles,
                frames,
                rays);
}

void print_columns() {
    std::printf(
        "| motion | policy | update, ms | rays, ms | sum, ms | trace rate | worst frame | cost in "
        "the end |\n"
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
}

void measure(const char* file, std::size_t rays) {
    constexpr int kFrames = 30;
    const auto scene = earshot::io::load_scene(file, {});
    const auto& source = scene.scene.mesh;
    const Mesh mesh = {source.positions_at(0.0),
                       {source.triangles().begin(), source.triangles().end()}};
    print_heading(file, mesh.triangles.size(), kFrames, rays);
    reinsert(mesh);
    if (rays == 0) {
        return;
    }
    print_columns();
    if (source.duration() > 0.0) {
        follow(
            "its animation",
            [&](double time) {
                return Mesh{source.positions_at(time * source.duration()), mesh.triangles};
            },
            kFrames,
            rays);
    }
    follow("wave", wave(mesh), kFrames, rays);
    follow("parts drift", drift(mesh, 12.0), kFrames, rays);
    follow("every triangle drifts", drift(mesh, 0.0), kFrames, rays);
    move_one_of_a_hundred(mesh);
}

void measure_city(std::size_t rays) {
    constexpr int kSteps = 100;
    const earshot::test::DriftingCity city;
    const Mesh rest = city.at(0.0);
    print_heading("Drifting city", rest.triangles.size(), kSteps, rays);
    reinsert(rest);
    print_columns();
    follow(
        "boxes drift", [&](double time) { return city.at(kSteps * time); }, kSteps, rays);
}

int run(int argc, char** argv) {
    constexpr std::size_t kDefaultRays = 100000;
    if (argc > 3) {
        std::fprintf(stderr, "usage: bench_bvh_update [MESH [RAYS]]\n");
        return 2;
    }
    if (argc == 1) {
        measure_city(kDefaultRays);
    } else {
        measure(argv[1], argc == 3 ? std::strtoull(argv[2], nullptr, 10) : kDefaultRays);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_bvh_update", argc, argv, run);
}
