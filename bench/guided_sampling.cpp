// SPDX-License-Identifier: MIT
//
// bench_guided_sampling [SCENE [X,Y,Z X,Y,Z [MILLION_RANDOM [MILLION_LONG]]]]: the PVS of a region,
// by guided sampling and by random rays, against the number of rays; how many random rays find as
// much; and what a guided run of a million rays misses of a much longer one.

#include "earshot/visibility/guided_sampling.h"

#include "earshot/visibility/pvs_validation.h"

#include "harness.h"
#include "sampling_setup.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>

namespace {

using namespace earshot;
using geometry::TriangleId;
using visibility::GuidedSamplingOptions;
using visibility::RegionPvs;

RegionPvs sample(SamplingSetup& setup, GuidedSamplingOptions options) {
    options.min_new_triangles = 0;  // only the number of rays ends the sampling
    return visibility::sample_region(setup.hierarchy.view(), setup.region, options, setup.executor);
}

std::uint64_t found(const RegionPvs& view, std::uint64_t rays) {
    return found_after(view.curve, &RegionPvs::Point::triangles, rays);
}

void print_curves(const RegionPvs& guided, const RegionPvs& no_reverse, const RegionPvs& plain) {
    std::printf("| rays | guided | without reverse | random | random rays for as many | times |\n");
    std::printf("| ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for (std::uint64_t rays = 1000; rays <= guided.rays; rays *= 10) {
        for (const std::uint64_t at : {rays, 3 * rays}) {
            if (at > guided.rays) {
                break;
            }
            const std::uint64_t triangles = found(guided, at);
            const std::uint64_t until =
                rays_until(plain.curve, &RegionPvs::Point::triangles, triangles);
            std::printf(
                "| %llu | %llu | %llu | %llu | %s%llu | %.0f |\n",
                static_cast<unsigned long long>(at),
                static_cast<unsigned long long>(triangles),
                static_cast<unsigned long long>(found(no_reverse, at)),
                static_cast<unsigned long long>(found(plain, at)),
                until > 0 ? "" : "over ",
                static_cast<unsigned long long>(until > 0 ? until : plain.rays),
                static_cast<double>(until > 0 ? until : plain.rays) / static_cast<double>(at));
        }
    }
}

std::size_t missing(const RegionPvs& view, const RegionPvs& other) {
    std::vector<TriangleId> lacks;
    std::set_difference(other.triangles.begin(),
                        other.triangles.end(),
                        view.triangles.begin(),
                        view.triangles.end(),
                        std::back_inserter(lacks));
    return lacks.size();
}

int run(int argc, char** argv) {
    SamplingSetup setup(argc, argv, {{126.0, 1.0, 126.0}, {130.0, 3.0, 130.0}});
    const auto million = [&](int k, double standard) {
        return static_cast<std::uint64_t>(1e6 * (argc > k ? std::atof(argv[k]) : standard));
    };
    const RegionPvs guided = sample(setup, {.max_rays = 1'000'000});
    const RegionPvs no_reverse = sample(setup, {.max_rays = 1'000'000, .reverse = false});
    const RegionPvs plain = sample(setup, {.max_rays = million(4, 100.0), .guided = false});
    const RegionPvs longer = sample(setup, {.max_rays = million(5, 100.0)});

    std::printf("%zu triangles\n\n", setup.mesh.triangles.size());
    print_curves(guided, no_reverse, plain);
    std::printf(
        "\n%zu after a million rays, %zu after %.0f million, of which the first lack %.2f %%;\n",
        guided.triangles.size(),
        longer.triangles.size(),
        1e-6 * static_cast<double>(longer.rays),
        100.0 * static_cast<double>(missing(guided, longer)) /
            static_cast<double>(longer.triangles.size()));
    std::printf("%zu by %.0f million random rays, of which both lack %zu and %zu\n",
                plain.triangles.size(),
                1e-6 * static_cast<double>(plain.rays),
                missing(guided, plain),
                missing(longer, plain));
    const visibility::MissedShare missed =
        visibility::validate_pvs(setup.hierarchy.view(),
                                 visibility::Objects::triangles(setup.mesh.triangles.size()),
                                 visibility::ViewCells(setup.region),
                                 std::vector<std::vector<visibility::ObjectId>>{guided.triangles},
                                 {.rays = 1'000'000},
                                 setup.executor);
    std::printf("the guided set misses %.2g of the directions, at most %.2g\n",
                missed.estimate(),
                missed.upper_bound());
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_guided_sampling", argc, argv, run);
}
