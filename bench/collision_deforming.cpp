// SPDX-License-Identifier: MIT
//
// bench_collision_deforming [MESH [THREADS]]: contacts at instants of meshes that deform, with
// trees that are kept from instant to instant, beside trees that are new at every instant: a cloth
// that falls over a ball, the layers of a skirt, balls that fly through each other, and MESH with
// every triangle drifting its own way, after which it rests. Processor time. Where FCL was there at
// configure time, it is asked for the contacts of cloth and ball.

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/collision/world.h"
#include "earshot/io/scene_file.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "collision_contenders.h"
#include "harness.h"
#include "support/collision_sequences.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace {

using earshot::Executor;
using earshot::collision::Contact;
using earshot::collision::World;
using earshot::collision::WorldStatistics;
using earshot::geometry::Triangle;
using earshot::geometry::Vec3;
using earshot::support::Part;

constexpr int kFrames = 30;

/// Every triangle of a mesh drifts by up to a quarter of its size during the first half of the
/// time, then rests there.
Part drifting(const std::string& file) {
    const auto scene = earshot::io::load_scene(file).scene;
    const std::vector<Vec3> positions = scene.mesh.positions_at(0.0);
    Vec3 lower = positions.front(), upper = lower;
    for (const Vec3& position : positions) {
        lower = glm::min(lower, position);
        upper = glm::max(upper, position);
    }
    Part part;
    std::vector<Vec3> corners, ways;
    for (const Triangle& t : scene.mesh.triangles()) {
        const auto first = static_cast<earshot::geometry::VertexId>(corners.size());
        part.triangles.push_back({first, first + 1, first + 2});
        const auto dice = [&](std::uint64_t k) {
            return earshot::random_between(1, k, part.triangles.size(), -1, 1);
        };
        ways.push_back(0.25 * glm::length(upper - lower) * Vec3(dice(0), dice(1), dice(2)));
        for (const auto vertex : t) {
            corners.push_back(positions[vertex]);
        }
    }
    part.at = [corners = std::move(corners), ways = std::move(ways)](double time) {
        std::vector<Vec3> moved = corners;
        for (std::size_t i = 0; i < moved.size(); ++i) {
            moved[i] += (0.1 + 0.9 * std::min(1.0, 2.0 * time)) * ways[i / 3];
        }
        return moved;
    };
    return part;
}

World world_of(const std::vector<Part>& parts) {
    World world;
    for (const Part& part : parts) {
        world.add_mesh(part.triangles, part.at(0.0).size());
    }
    return world;
}

void move(World& world, const std::vector<Part>& parts, double time) {
    for (std::uint32_t mesh = 0; mesh < parts.size(); ++mesh) {
        const std::vector<Vec3> positions = parts[mesh].at(time);
        world.update(mesh, positions, positions);
    }
}

std::uint64_t digest_of(const std::vector<Contact>& contacts) {
    earshot::Digest digest;
    for (const Contact& contact : contacts) {
        for (const auto* element : {&contact.a, &contact.b}) {
            digest.add(element->mesh);
            for (const auto vertex : element->vertices) {
                digest.add(vertex);
            }
        }
    }
    return digest.value();
}

/// Contacts at an instant, with self-contacts, and the processor time that they took.
struct Asked {
    std::vector<Contact> contacts;
    double ms = 0.0;
};

Asked ask(World& world, Executor& executor) {
    Asked asked;
    asked.ms = 1e3 * bench::times_of([&] {
                         asked.contacts =
                             world.contacts_at_begin({.within_meshes = true}, executor);
                     }).processor;
    return asked;
}

/// Asks what needs the shapes and tells no contacts.
void build_shapes(World& world, Executor& executor) {
    for (std::uint32_t mesh = 0; mesh < world.mesh_count(); ++mesh) {
        world.distance_at_begin(mesh, mesh, executor);
    }
}

void measure(const char* name, const std::vector<Part>& parts, Executor& executor) {
    World kept = world_of(parts);
    std::vector<double> with_kept, in_fresh, with_fresh;
    WorldStatistics all;
    std::size_t contacts = 0;
    bool same = true;
    for (int frame = 0; frame <= kFrames; ++frame) {
        const double time = frame / double(kFrames);
        move(kept, parts, time);
        const Asked in_kept = ask(kept, executor);
        all += kept.statistics();
        World fresh = world_of(parts);
        move(fresh, parts, time);
        const Asked built = ask(fresh, executor);
        World prepared = world_of(parts);
        move(prepared, parts, time);
        build_shapes(prepared, executor);
        const Asked searched = ask(prepared, executor);
        same = same && digest_of(in_kept.contacts) == digest_of(built.contacts);
        contacts += in_kept.contacts.size();
        if (frame > 0) {  // which builds the kept trees too
            with_kept.push_back(in_kept.ms);
            in_fresh.push_back(searched.ms);
            with_fresh.push_back(built.ms);
        }
    }
    const double kept_median = bench::median(with_kept);
    const double fresh_median = bench::median(in_fresh);
    const double build_median = bench::median(with_fresh);
    std::printf("| %s | %.1f | %.1f | %.1f | %.2f | %.2f | %llu / %llu / %llu | %zu%s |\n",
                name,
                kept_median,
                fresh_median,
                build_median,
                kept_median / fresh_median,
                kept_median / build_median,
                static_cast<unsigned long long>(all.updates.refits),
                static_cast<unsigned long long>(all.updates.repairs),
                static_cast<unsigned long long>(all.updates.rebuilds),
                contacts,
                same ? "" : ", WHICH DIFFER");
    std::fflush(stdout);
}

/// Contacts of two meshes, without those within them.
void measure_beside_fcl(const std::vector<Part>& parts) {
    const auto fcl = bench::fcl_contender();
    if (!fcl) {
        std::printf("\nFCL: not there at configure time, not measured\n");
        return;
    }
    World kept = world_of(parts);
    std::vector<double> ours, refitted, rebuilt;
    for (int frame = 0; frame <= kFrames; ++frame) {
        const double time = frame / double(kFrames);
        move(kept, parts, time);
        ours.push_back(1e3 * bench::times_of([&] { kept.contacts_at_begin(); }).processor);
        const std::vector<Vec3> a = parts[0].at(time), b = parts[1].at(time);
        const auto ask = [&](bool refit) {
            return 1e3 * bench::times_of([&] {
                             refit ? fcl->refit({a, parts[0].triangles}, {b, parts[1].triangles})
                                   : fcl->build({a, parts[0].triangles}, {b, parts[1].triangles});
                             fcl->contacts({});
                         }).processor;
        };
        rebuilt.push_back(ask(false));
        refitted.push_back(ask(true));
    }
    const double median = bench::median(ours);
    std::printf(
        "\ncloth and ball, ms an instant: earshot %.1f; FCL refitted %.1f, rebuilt %.1f: "
        "%.1f and %.1f times\n",
        median,
        bench::median(refitted),
        bench::median(rebuilt),
        bench::median(refitted) / median,
        bench::median(rebuilt) / median);
}

int run(int argc, char** argv) {
    Executor executor(argc > 2 ? std::atoi(argv[2]) : 1);
    std::printf(
        "%d threads; processor ms of an instant, median of %d; kept: updated and searched; "
        "fresh: searched alone, and built and searched\n\n"
        "| sequence | kept | fresh, searched | fresh, built | kept / searched | kept / "
        "built | refits / repairs / rebuilds | contacts |\n"
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
        executor.threads(),
        kFrames);
    const auto cloth = earshot::support::cloth_on_ball(100);
    measure("cloth on ball", cloth, executor);
    measure("skirt", earshot::support::skirt(104, 12), executor);
    measure("balls", earshot::support::flying_balls(60, 32, 20), executor);
    if (argc > 1) {
        measure("drifting triangles", {drifting(argv[1])}, executor);
    }
    measure_beside_fcl(cloth);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_collision_deforming", argc, argv, run);
}
