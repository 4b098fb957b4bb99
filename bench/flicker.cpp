// SPDX-License-Identifier: MIT
//
// bench_flicker [UPDATES [PICTURE.svg]]: how echograms flicker from update to update while a source
// walks, against the number of virtual sources that an update may test, by ways to choose these;
// for each audio::temporal_difference(). The exact echogram is that of all virtual sources. The
// picture shows the first walk.

#include "earshot/audio/temporal_difference.h"
#include "earshot/base/math.h"
#include "earshot/io/scene_file.h"
#include "earshot/io/svg.h"
#include "earshot/propagation/coherent_late_sound.h"
#include "earshot/propagation/simulator.h"

#include "harness.h"
#include "support/sampling_rivals.h"
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using earshot::audio::EnergyHistogram;
using earshot::audio::TemporalDifference;
using earshot::geometry::Vec3;
using earshot::io::SvgPicture;
using earshot::io::SvgPoint;
using namespace earshot::propagation;
namespace support = earshot::support;

/// A source that walks along x, 5 cm per update, from where the first of the scene is.
struct Walk {
    const char* name;
    const char* scene;
    /// The rays are those of the listener, which stays: by reciprocity these find the same.
    bool rays_of_listener = true;
    double end = 0.0;  // time of the scene, which begins at 0
};

constexpr std::array<Walk, 4> kWalks = {
    Walk{"classroom, rays of the listener", "scenes/classroom.gltf"},
    Walk{"classroom, rays of the source", "scenes/classroom.gltf", false},
    Walk{"two rooms, rays of the listener", "scenes/door.gltf"},
    Walk{"two rooms while the door opens, rays of the listener", "scenes/door.gltf", true, 2.0}};

struct Update {
    const CoherentLateSound& late;
    std::span<const double> importances;
    Vec3 listener;
    std::uint64_t number;
};

using Choose = std::function<std::vector<WeightedSample>(const Update&, std::size_t budget)>;

struct Method {
    const char* name;
    const char* colour;
    Choose choose;
};

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kProposals = 8;

const std::vector<Method>& methods() {
    static const std::vector<Method> all = {
        {"new numbers",
         "#8d96a3",
         [](const Update& u, std::size_t budget) {
             return support::independent_samples(u.importances, budget, 1000 + u.number);
         }},
        {"inverse transform",
         "#d1495b",
         [](const Update& u, std::size_t budget) {
             return support::inverse_transform_samples(u.importances, budget, kSeed);
         }},
        {"Metropolis-Hastings",
         "#edae49",
         [](const Update& u, std::size_t budget) {
             return support::metropolis_hastings_samples(u.importances, budget, kProposals, kSeed);
         }},
        {"RIS",
         "#30638e",
         [](const Update& u, std::size_t budget) {
             return support::resampling_samples(u.importances, budget, kProposals, kSeed);
         }},
        {"uniform",
         "#2a7d3f",
         [](const Update& u, std::size_t budget) {
             return support::uniform_samples(u.importances.size(), budget, kSeed);
         }},
        {"coherent",
         "#00798c",
         [](const Update& u, std::size_t budget) {
             return coherent_samples(u.importances, u.late.keys(), budget);
         }},
        {"coherent, in strata",
         "#111111",
         [](const Update& u, std::size_t budget) { return u.late.choose(u.listener, budget); }},
    };
    return all;
}

const std::vector<std::size_t>& budgets() {
    static const std::vector<std::size_t> all = {16, 32, 64, 128, 256, 512, 1024, 2048, 4096};
    return all;
}

/// Per method and budget.
struct Results {
    std::vector<std::vector<TemporalDifference>> rows;
    double mean_virtual_sources = 0.0;
};

std::vector<WeightedSample> all_of(std::size_t count) {
    std::vector<WeightedSample> all;
    for (std::size_t i = 0; i < count; ++i) {
        all.push_back({i, 1.0});
    }
    return all;
}

Results measure(const Walk& walk, std::size_t updates) {
    const auto loaded = earshot::io::load_scene(walk.scene);
    const Vec3 source = loaded.scene.position_at(loaded.scene.sources.front(), 0.0);
    const Vec3 listener = loaded.scene.position_at(loaded.scene.listeners.front(), 0.0);
    Simulator simulator(loaded.scene);
    const RayOptions options = {.rays = 512, .seed = kSeed, .length = 0.5};
    CoherentLateSound late(options);
    std::vector<EnergyHistogram> exact;
    std::vector<std::vector<std::vector<EnergyHistogram>>> estimates(
        methods().size(), std::vector<std::vector<EnergyHistogram>>(budgets().size()));
    const auto count = static_cast<double>(updates);
    Results results;
    for (std::size_t u = 0; u < updates; ++u) {
        simulator.set_time(walk.end * static_cast<double>(u) / count);
        const Vec3 moving = source + Vec3(0.05 * static_cast<double>(u), 0.0, 0.0);
        const Vec3 start = walk.rays_of_listener ? listener : moving;
        const Vec3 end = walk.rays_of_listener ? moving : listener;
        const RayScene scene = simulator.ray_scene();
        late.update(scene, {.pose = {.position = start}});
        const std::vector<double> importances = late.importances(end);
        const Update update{late, importances, end, u};
        exact.push_back(late.energy_of(end, all_of(importances.size())));
        results.mean_virtual_sources += static_cast<double>(importances.size()) / count;
        for (std::size_t m = 0; m < methods().size(); ++m) {
            for (std::size_t n = 0; n < budgets().size(); ++n) {
                estimates[m][n].push_back(
                    late.energy_of(end, methods()[m].choose(update, budgets()[n])));
            }
        }
    }
    for (const auto& of_method : estimates) {
        auto& row = results.rows.emplace_back();
        for (const auto& of_budget : of_method) {
            row.push_back(
                earshot::audio::temporal_difference(of_budget, exact, options.bands.count()));
        }
    }
    return results;
}

void print(const Walk& walk, const Results& results) {
    std::printf("\n%s, %.0f virtual sources\n\n| |", walk.name, results.mean_virtual_sources);
    for (const std::size_t budget : budgets()) {
        std::printf(" %zu |", budget);
    }
    std::printf("\n| --- |");
    for (std::size_t n = 0; n < budgets().size(); ++n) {
        std::printf(" --- |");
    }
    for (std::size_t m = 0; m < methods().size(); ++m) {
        std::printf("\n| %s |", methods()[m].name);
        for (const TemporalDifference& value : results.rows[m]) {
            std::printf(" %.3f / %.3f |", value.difference, value.error);
        }
    }
    std::printf("\n");
}

/// One of two diagrams side by side; both axes are logarithmic.
struct Panel {
    double left;
    const char* title;
    double TemporalDifference::*value;
};

constexpr double kTop = 40.0, kBottom = 320.0, kWidth = 300.0;
constexpr double kLowest = 0.01, kHighest = 10.0;

double x_of(const Panel& panel, std::size_t budget) {
    return panel.left + kWidth *
                            earshot::math::log2(static_cast<double>(budget) /
                                                static_cast<double>(budgets().front())) /
                            static_cast<double>(budgets().size() - 1);
}

double y_of(double value) {
    const double bounded = std::clamp(value, kLowest, kHighest);
    return kBottom - (kBottom - kTop) * earshot::math::log10(bounded / kLowest) / 3.0;
}

void draw(const Panel& panel, const Results& results, SvgPicture& picture) {
    picture.text({panel.left, kTop - 16.0}, panel.title);
    for (const auto& [value, label] :
         {std::pair(0.01, "1 %"), {0.1, "10 %"}, {1.0, "100 %"}, {10.0, "1000 %"}}) {
        picture.line({panel.left, y_of(value)}, {panel.left + kWidth, y_of(value)}, "#ddd");
        picture.text({panel.left - 6.0, y_of(value) + 4.0}, label, {.anchor = "end"});
    }
    for (std::size_t n = 0; n < budgets().size(); n += 2) {
        const double x = x_of(panel, budgets()[n]);
        picture.line({x, kBottom}, {x, kBottom + 4.0}, "black");
        picture.text({x, kBottom + 18.0}, std::to_string(budgets()[n]), {.anchor = "middle"});
    }
    for (std::size_t m = 0; m < methods().size(); ++m) {
        std::vector<SvgPoint> points;
        for (std::size_t n = 0; n < budgets().size(); ++n) {
            points.push_back({x_of(panel, budgets()[n]), y_of(results.rows[m][n].*panel.value)});
        }
        picture.polyline(points, methods()[m].colour, m + 1 == methods().size() ? 3.0 : 1.5);
    }
}

std::string picture_of(const Results& results) {
    SvgPicture picture(760.0, 410.0, 12.0, "flicker against the budget");
    draw({60.0, "difference from update to update", &TemporalDifference::difference},
         results,
         picture);
    draw({440.0, "error", &TemporalDifference::error}, results, picture);
    picture.text({400.0, kBottom + 38.0}, "virtual sources per update", {.anchor = "middle"});
    double x = 60.0;
    for (const Method& method : methods()) {
        picture.line({x, 390.0}, {x + 14.0, 390.0}, method.colour, 3.0);
        picture.text({x + 18.0, 394.0}, method.name, {.size = 10.0});
        x += 30.0 + earshot::io::svg_text_width(method.name, 10.0);
    }
    return picture.str();
}

int run(int argc, char** argv) {
    const std::size_t updates = argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : 40;
    for (std::size_t k = 0; k < kWalks.size(); ++k) {
        const Results results = measure(kWalks[k], updates);
        print(kWalks[k], results);
        if (k == 0 && argc > 2) {
            std::ofstream(argv[2]) << picture_of(results);
        }
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return bench::run_main("bench_flicker", argc, argv, run);
}
