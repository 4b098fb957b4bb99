// SPDX-License-Identifier: MIT
// Metrics of exact early paths and rays together, against sums over all image sources of a box
// (Allen and Berkley 1979). Differences are counted in just-noticeable ones (ISO 3382-1:2009, table
// A.1): 5 % of EDT, T20 and T30, 1 dB of C50, C80 and G, 0.05 of D50, 10 ms of Ts.
#include "earshot/audio/energy_metrics.h"
#include "earshot/propagation/simulator.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/decay_line.h"
#include "support/dice.h"
#include "support/rooms.h"
#include "support/test_paths.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace earshot::support {
namespace {

using geometry::Vec3;

constexpr std::size_t kBand = 5;  // 1 kHz
constexpr double kSpeed = 343.0;

struct BoxCase {
    Vec3 size{}, source{}, listener{};
    std::array<double, 6> absorption{};  // low x, high x, low y, high y, low z, high z
    double scattering = 0.0;
};

using Values = std::array<double, 8>;  // EDT, T20, T30, C50, C80, D50, Ts, G
constexpr std::array<const char*, 8> kNames = {
    {"EDT", "T20", "T30", "C50", "C80", "D50", "Ts", "G"}};

/// How many just-noticeable differences apart.
double difference(std::size_t metric, double a, double b) {
    constexpr std::array<double, 8> kUnits = {{0.05, 0.05, 0.05, 1.0, 1.0, 0.05, 0.01, 1.0}};
    const double relative = metric < 3 ? b : 1.0;
    return std::abs(a - b) / (kUnits[metric] * relative);
}

propagation::Scene scene_of(const BoxCase& box) {
    const Room room = box_room(Vec3(0.0), box.size);
    propagation::Scene scene;
    for (std::size_t wall = 0; wall < 6; ++wall) {
        propagation::Material material;
        material.absorption = propagation::EnergyCoefficient(box.absorption[wall]);
        material.scattering = propagation::EnergyCoefficient(box.scattering);
        scene.materials.push_back(material);
    }
    scene.material_of_triangle = room.labels;
    scene.mesh = geometry::AnimatedMesh::fixed(room.mesh);
    scene.sources = {{.name = "s", .node = -1, .position = box.source}};
    scene.listeners = {{.name = "l", .node = -1, .position = box.listener}};
    return scene;
}

Values values_of(const audio::BandMetrics& band, double missing) {
    const auto value = [&](const std::optional<double>& metric) {
        return metric.value_or(missing);
    };
    return {value(band.early_decay_time),
            value(band.reverberation_time_t20),
            value(band.reverberation_time_t30),
            value(band.clarity_c50_db),
            value(band.clarity_c80_db),
            value(band.definition_d50),
            value(band.centre_time),
            value(band.strength_db)};
}

/// Of late sound; as many as it takes where an error is given.
struct Rays {
    std::size_t count = 20000;
    double max_error = 0.0;
};
constexpr Rays kDefaultRays = {1000000, 0.02};  // of earshot ir

/// As metrics.json has them: a value that is withheld is far off.
audio::RoomMetrics metrics_of(const BoxCase& box,
                              int order,
                              std::uint64_t seed = 1,
                              const Rays& rays = {}) {
    const propagation::Scene scene = scene_of(box);
    const double temperature_c = 293.15 * (kSpeed / 343.2) * (kSpeed / 343.2) - 273.15;
    const propagation::Options options = {.specular_order = order,
                                          .air = {.temperature_c = temperature_c},
                                          .air_absorption = false,
                                          .rays = rays.count,
                                          .max_error = rays.max_error,
                                          .seed = seed};
    Executor executor(2);
    propagation::Simulator simulator(scene, options, executor);
    const auto pair = simulator.run(executor).front();
    return audio::energy_metrics(options.bands,
                                 propagation::arrivals_of(pair),
                                 pair.late,
                                 {.replicates = &pair.late_replicates});
}

Values found_values(const BoxCase& box, int order, std::uint64_t seed = 1, const Rays& rays = {}) {
    return values_of(metrics_of(box, order, seed, rays).bands[kBand], 1e9);
}

/// Energies of all images until the sound has decayed, on a grid of half a millisecond from the
/// direct sound on.
Values exact_values(const BoxCase& box, double until) {
    constexpr double kStep = 5e-4;
    const double direct = glm::distance(box.source, box.listener) / kSpeed;
    std::vector<double> energies(static_cast<std::size_t>(until / kStep) + 1);
    double moment = 0.0;
    std::array<int, 3> most{};
    for (int axis = 0; axis < 3; ++axis) {
        most[static_cast<std::size_t>(axis)] =
            static_cast<int>(kSpeed * (until + direct) / box.size[axis]) + 2;
    }
    // Along each axis image n lies n rooms on, after |n| bounces from the two walls in turns.
    const auto offset = [&](int axis, int n) {
        const double place = n % 2 == 0 ? box.source[axis] : box.size[axis] - box.source[axis];
        return n * box.size[axis] + place - box.listener[axis];
    };
    const auto kept = [&](int axis, int n) {
        const int bounces = std::abs(n);
        const int at_high = n > 0 ? (bounces + 1) / 2 : bounces / 2;
        const auto low = static_cast<std::size_t>(2 * axis);
        return std::pow(1.0 - box.absorption[low], bounces - at_high) *
               std::pow(1.0 - box.absorption[low + 1], at_high);
    };
    for (int x = -most[0]; x <= most[0]; ++x) {
        const double dx = offset(0, x), kx = kept(0, x);
        for (int y = -most[1]; y <= most[1]; ++y) {
            const double dy = offset(1, y), kxy = kx * kept(1, y);
            for (int z = -most[2]; z <= most[2]; ++z) {
                const double dz = offset(2, z);
                const double squared = dx * dx + dy * dy + dz * dz;
                const double time = std::sqrt(squared) / kSpeed - direct;
                const auto n = static_cast<std::size_t>(time / kStep + 1e-9);
                if (n < energies.size()) {
                    const double energy = kxy * kept(2, z) / squared;
                    energies[n] += energy;
                    moment += time * energy;
                }
            }
        }
    }
    std::vector<double> remaining = energies;
    for (std::size_t n = remaining.size() - 1; n-- > 0;) {
        remaining[n] += remaining[n + 1];
    }
    const double whole = remaining.front();
    const auto after = [&](double time) {
        return remaining[static_cast<std::size_t>(std::lround(time / kStep))] / whole;
    };
    const auto clarity = [&](double time) {
        return 10.0 * std::log10((1.0 - after(time)) / after(time));
    };
    return {line_time(remaining, kStep, 0.0, 10.0),
            line_time(remaining, kStep, 5.0, 25.0),
            line_time(remaining, kStep, 5.0, 35.0),
            clarity(0.05),
            clarity(0.08),
            1.0 - after(0.05),
            moment / whole,
            10.0 * std::log10(100.0 * whole)};
}

void expect_near(const Values& found, const Values& expected, double most, const char* what) {
    for (std::size_t metric = 0; metric < found.size(); ++metric) {
        EXPECT_LT(difference(metric, found[metric], expected[metric]), most)
            << what << ": " << kNames[metric] << " " << found[metric] << " for "
            << expected[metric];
    }
}

/// Two estimates of each metric are within 3.5 of their combined standard errors.
void expect_within_errors(const audio::RoomMetrics& a,
                          const audio::RoomMetrics& b,
                          const std::string& what) {
    const Values of_a = values_of(a.bands[kBand], 0.0), of_b = values_of(b.bands[kBand], 0.0);
    const Values error_a = values_of(a.standard_error.bands[kBand], 0.0);
    const Values error_b = values_of(b.standard_error.bands[kBand], 0.0);
    for (std::size_t metric = 0; metric < of_a.size(); ++metric) {
        EXPECT_GT(error_a[metric], 0.0) << what << ": " << kNames[metric];
        EXPECT_LT(std::abs(of_a[metric] - of_b[metric]),
                  3.5 * std::hypot(error_a[metric], error_b[metric]))
            << what << ": " << kNames[metric];
    }
}

/// Walls of one absorption each, points off the walls.
BoxCase random_box(Dice& dice) {
    BoxCase box;
    for (int axis = 0; axis < 3; ++axis) {
        box.size[axis] = dice.between(2.5, 10.0);
        box.source[axis] = box.size[axis] * dice.between(0.15, 0.85);
        box.listener[axis] = box.size[axis] * dice.between(0.15, 0.85);
    }
    const double mean = dice.between(0.15, 0.4);
    for (double& absorption : box.absorption) {
        absorption = mean * dice.between(0.6, 1.4);
    }
    return box;
}

/// Norris and Eyring's, with some room for boxes that decay more slowly.
double decay_of(const BoxCase& box) {
    const Vec3& s = box.size;
    double area = 0.0, absorbed = 0.0;
    for (std::size_t wall = 0; wall < 6; ++wall) {
        const int axis = static_cast<int>(wall / 2);
        const double wall_area = s.x * s.y * s.z / s[axis];
        area += wall_area;
        absorbed += wall_area * box.absorption[wall];
    }
    return 1.8 * 0.161 * s.x * s.y * s.z / (-area * std::log(1.0 - absorbed / area));
}

TEST(RoomAcoustics, MetricsOfTheReferenceBoxesAreThoseOfAllImages) {
    std::ifstream file(test::source_file("tests/data/shoebox-exact-metrics.json"));
    const auto table = nlohmann::json::parse(file);
    // The table is z up; a box does not mind.
    const auto point = [](const nlohmann::json& v) {
        return Vec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
    };
    for (const auto& row : table["cases"]) {
        const BoxCase box = {.size = point(row["L"]),
                             .source = point(row["src"]),
                             .listener = point(row["rec"]),
                             .absorption = row["alpha_x0x1y0y1z0z1"].get<std::array<double, 6>>()};
        const Values expected = {row["EDT"],
                                 row["T20"],
                                 row["T30"],
                                 row["C50"],
                                 row["C80"],
                                 row["D50"],
                                 row["Ts_ms"].get<double>() / 1000.0,
                                 row["G_dB_re_10m"]};
        expect_near(found_values(box, 3, 1, kDefaultRays),
                    expected,
                    1.0,
                    row["case"].get<std::string>().c_str());
    }
}

TEST(RoomAcoustics, MetricsOfRandomBoxesAreThoseOfAllImages) {
    Dice dice(17);
    for (int i = 0; i < 10; ++i) {
        const BoxCase box = random_box(dice);
        const std::string what = "box " + std::to_string(i);
        expect_near(found_values(box, 3, 1, kDefaultRays),
                    exact_values(box, decay_of(box)),
                    1.0,
                    what.c_str());
    }
}

TEST(RoomAcoustics, TheClosedFormIsTheTables) {
    const BoxCase office = {.size = {8, 6, 3.5},
                            .source = {2, 1.5, 1.2},
                            .listener = {5.5, 4, 1.6},
                            .absorption = {0.4, 0.4, 0.4, 0.4, 0.4, 0.4}};
    const Values expected = {0.29249, 0.34510, 0.36825, 9.9297, 15.9883, 0.90774, 0.019826, 15.441};
    expect_near(exact_values(office, 0.6), expected, 0.3, "office");
}

TEST(RoomAcoustics, TheOrderOfExactPathsMovesNoMetric) {
    const BoxCase box = {.size = {7, 3, 5},
                         .source = {2, 1.5, 1.2},
                         .listener = {5.5, 1.3, 3.6},
                         .absorption = {0.3, 0.2, 0.25, 0.4, 0.3, 0.2},
                         .scattering = 0.2};
    const audio::RoomMetrics reference = metrics_of(box, 4);
    for (const int order : {0, 1, 2, 3}) {
        const std::string what = "order " + std::to_string(order);
        const audio::RoomMetrics metrics = metrics_of(box, order);
        expect_near(values_of(metrics.bands[kBand], 1e9),
                    values_of(reference.bands[kBand], 1e9),
                    0.5,
                    what.c_str());
        expect_within_errors(metrics, reference, what);
    }
}

// Few rays: the errors that are told are the spread over seeds.
TEST(RoomAcoustics, StandardErrorsAreTheSpreadOverSeeds) {
    const BoxCase box = {.size = {4, 2.6, 3},
                         .source = {1.1, 1.5, 0.8},
                         .listener = {2.9, 1.3, 2.1},
                         .absorption = {0.3, 0.2, 0.25, 0.4, 0.3, 0.2},
                         .scattering = 0.3};
    constexpr std::size_t kSeeds = 30;
    std::vector<audio::RoomMetrics> found;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        found.push_back(metrics_of(box, 0, seed));
    }
    for (std::size_t metric = 0; metric < kNames.size(); ++metric) {
        double mean = 0.0, variance = 0.0, claimed = 0.0;
        for (const audio::RoomMetrics& metrics : found) {
            mean += values_of(metrics.bands[kBand], 0.0)[metric] / kSeeds;
        }
        for (const audio::RoomMetrics& metrics : found) {
            variance += std::pow(values_of(metrics.bands[kBand], 0.0)[metric] - mean, 2);
            claimed += std::pow(values_of(metrics.standard_error.bands[kBand], 0.0)[metric], 2);
        }
        // Of 30 seeds the spread itself is uncertain by 13 %.
        const double ratio = std::sqrt(variance / (kSeeds - 1.0) / (claimed / kSeeds));
        RecordProperty(std::string("spread_by_error_") + kNames[metric], std::to_string(ratio));
        EXPECT_GT(ratio, 0.8) << kNames[metric];
        EXPECT_LT(ratio, 1.25) << kNames[metric];
    }
}

TEST(RoomAcoustics, SeedsSpreadTheReverberationTimeLittle) {
    const BoxCase box = {.size = {8, 3.5, 6},
                         .source = {2, 1.5, 1.2},
                         .listener = {5.5, 1.3, 4.1},
                         .absorption = {0.3, 0.2, 0.25, 0.4, 0.3, 0.2},
                         .scattering = 0.2};
    constexpr int kSeeds = 5;
    double sum = 0.0, squares = 0.0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const double time = found_values(box, 3, seed)[2];
        sum += time / kSeeds;
        squares += time * time / kSeeds;
    }
    EXPECT_LT(std::sqrt((squares - sum * sum) * kSeeds / (kSeeds - 1.0)), 0.015 * sum);
}

}  // namespace
}  // namespace earshot::support
