// SPDX-License-Identifier: MIT
//
// bench_global_sampling [SCENE [X,Y,Z X,Y,Z [NX NY NZ [GROUP [MILLIONS]]]]]: entries of the visible
// sets of all cells of a grid against the number of rays, by mixtures of the distributions; and how
// many rays of the view space-direction distribution alone find as much as the whole mixture.
// GROUP: most triangles of an object. MILLIONS: of rays of that distribution alone.

#include "earshot/visibility/global_sampling.h"

#include "earshot/visibility/pvs_validation.h"

#include "harness.h"
#include "sampling_setup.h"
#include <array>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace earshot;
using visibility::GlobalPvs;
using visibility::GlobalSamplingOptions;

constexpr std::uint64_t kMillion = 1'000'000;

struct Mixture {
    const char* name;
    std::array<bool, visibility::kSampleDistributions> distributions;
    std::uint64_t rays;
};

std::uint64_t entries_after(const GlobalPvs& view, std::uint64_t rays) {
    return found_after(view.curve, &GlobalPvs::Point::entries, rays);
}

void print_row(const Mixture& mixture,
               const GlobalPvs& view,
               const visibility::MissedShare& missed) {
    std::printf("| %s |", mixture.name);
    for (const std::uint64_t rays : {kMillion / 10, kMillion, 3 * kMillion, 10 * kMillion}) {
        std::printf(" %llu |", static_cast<unsigned long long>(entries_after(view, rays)));
    }
    std::printf(" %.2g | %.2g |\n", missed.estimate(), missed.upper_bound());
}

void print_ratios(const GlobalPvs& all, const GlobalPvs& plain) {
    std::printf("\n| rays of the mixture | entries | view directions for as many | times |\n");
    std::printf("| ---: | ---: | ---: | ---: |\n");
    for (const std::uint64_t rays : {kMillion / 10, kMillion / 3, kMillion, 3 * kMillion}) {
        const std::uint64_t entries = entries_after(all, rays);
        const std::uint64_t until = rays_until(plain.curve, &GlobalPvs::Point::entries, entries);
        const std::uint64_t shown = until > 0 ? until : plain.rays;
        std::printf("| %llu | %llu | %s%llu | %.0f |\n",
                    static_cast<unsigned long long>(rays),
                    static_cast<unsigned long long>(entries),
                    until > 0 ? "" : "over ",
                    static_cast<unsigned long long>(shown),
                    static_cast<double>(shown) / static_cast<double>(rays));
    }
}

int run(int argc, char** argv) {
    SamplingSetup setup(argc, argv, {{1.0, 1.0, 1.0}, {239.0, 3.0, 239.0}});
    std::array<std::uint32_t, 3> counts = {16, 2, 16};
    for (int k = 0; k < 3 && argc > 4 + k; ++k) {
        counts[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(std::atoi(argv[4 + k]));
    }
    const std::size_t group = argc > 7 ? static_cast<std::size_t>(std::atoi(argv[7])) : 32;
    const std::uint64_t millions = argc > 8 ? static_cast<std::uint64_t>(std::atoi(argv[8])) : 60;

    const auto objects = visibility::Objects::groups(setup.mesh, group, setup.executor);
    const auto cells = visibility::ViewCells::grid(setup.region, counts);
    std::printf("%zu triangles in %zu objects, %zu cells\n\n",
                setup.mesh.triangles.size(),
                objects.size(),
                cells.size());
    std::printf("| mixture | 0.1 M rays | 1 M | 3 M | 10 M | missed share | at most |\n");
    std::printf("| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    GlobalPvs plain;
    GlobalPvs last;
    for (const Mixture& mixture :
         {Mixture{"view directions", {true, false, false, false, false}, millions * kMillion},
          Mixture{"two points", {false, false, true, false, false}, 10 * kMillion},
          Mixture{"these and object directions", {true, true, true, false, false}, 10 * kMillion},
          Mixture{"and two-point mutations", {true, true, true, true, false}, 10 * kMillion},
          Mixture{"and silhouettes: all", {true, true, true, true, true}, 10 * kMillion}}) {
        const GlobalSamplingOptions options = {.max_rays = mixture.rays,
                                               .window = 2 * mixture.rays,
                                               .samples_per_batch = 10'000,
                                               .distributions = mixture.distributions};
        last = visibility::sample_cells(
            setup.hierarchy.view(), objects, cells, options, setup.executor);
        print_row(mixture,
                  last,
                  visibility::validate_pvs(setup.hierarchy.view(),
                                           objects,
                                           cells,
                                           last.visible,
                                           {.rays = 1'000'000},
                                           setup.executor));
        if (mixture.distributions == std::array{true, false, false, false, false}) {
            plain = last;
        }
    }
    print_ratios(last, plain);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_global_sampling", argc, argv, run);
}
