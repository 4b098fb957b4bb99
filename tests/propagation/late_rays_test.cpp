// SPDX-License-Identifier: MIT
#include "earshot/propagation/late_rays.h"

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/base/standard_error.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "one_material_scene.h"
#include "support/decay_line.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kPi = 3.141592653589793;

/// A closed box of one material.
struct BoxRoom : OneMaterialScene {
    Vec3 size;

    BoxRoom(const Vec3& the_size, double absorption, double scattering)
        : OneMaterialScene(box_mesh(the_size), absorption, scattering), size(the_size) {}

    double volume() const { return size.x * size.y * size.z; }
    double surface() const { return 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x); }
};

constexpr std::size_t kBand = 5;  // 1 kHz

std::vector<double> energies(const audio::EnergyHistogram& histogram) {
    std::vector<double> result;
    for (const audio::Spectrum& bin : histogram.energy) {
        result.push_back(bin[kBand]);
    }
    return result;
}

/// Reverberation time from a line through the backward integral from -5 to -35 dB.
double decay_time(const audio::EnergyHistogram& histogram) {
    std::vector<double> level = energies(histogram);
    for (std::size_t n = level.size() - 1; n-- > 0;) {
        level[n] += level[n + 1];
    }
    return support::line_time(level, histogram.bin, 5.0, 35.0);
}

/// Eyring's with Kuttruff's correction for the spread of free paths (Kuttruff 2009, section 5.5).
double eyring_time(const BoxRoom& room, double absorption, double path_variance) {
    const double exponent = -std::log(1.0 - absorption);
    const double corrected = exponent * (1.0 - 0.5 * path_variance * exponent);
    return 24.0 * std::log(10.0) / 343.2 * room.volume() / (room.surface() * corrected);
}

RaySource source_at(const Vec3& position) {
    return {.pose = {.position = position}};
}

RayOptions options_for(double length) {
    return {.length = length, .air_absorption = false};
}

TEST(LateRays, TheEnergyThatLeftTheSourceIsAccountedFor) {
    const BoxRoom room({5, 3, 4}, 0.3, 0.4);
    const std::vector<Vec3> listeners = {{3, 1.5, 2.5}};
    RayOptions options = options_for(0.4);
    options.rays = 3000;
    const LateEnergy late = trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options);
    const EnergyBalance& balance = late.balance;
    EXPECT_NEAR(balance.emitted[kBand], 4.0 * kPi, 1e-10);
    EXPECT_EQ(balance.escaped[kBand], 0.0);
    EXPECT_NEAR((balance.absorbed[kBand] + balance.escaped[kBand] + balance.remaining[kBand]) /
                    balance.emitted[kBand],
                1.0,
                1e-10);
    EXPECT_GT(balance.absorbed[kBand], 0.99 * balance.emitted[kBand]);
}

/// Bands that absorb and scatter unlike each other.
void make_uneven(Material& material) {
    material.absorption = EnergyCoefficient({{125.0, 0.1}, {1000.0, 0.3}, {8000.0, 0.5}});
    material.scattering = EnergyCoefficient({{125.0, 0.05}, {1000.0, 0.4}, {8000.0, 0.9}});
}

TEST(LateRays, TheBalanceHoldsInEveryBandWhereBandsScatterUnlike) {
    BoxRoom room({5, 3, 4}, 0.3, 0.4);
    make_uneven(room.materials[0]);
    RayOptions options = options_for(0.4);
    options.rays = 20000;
    const EnergyBalance balance =
        trace_late_rays(room.scene(), source_at({1, 1, 1}), {}, options).balance;
    double emitted = 0.0, ended = 0.0;
    for (std::size_t band = 0; band < options.bands.count(); ++band) {
        const double end = balance.absorbed[band] + balance.escaped[band] + balance.remaining[band];
        EXPECT_NEAR((balance.emitted[band] + balance.roulette_surplus[band]) / end, 1.0, 1e-10)
            << band;
        // Chance alone: its mean is 0.
        EXPECT_NEAR(balance.roulette_surplus[band] / balance.emitted[band], 0.0, 0.05) << band;
        EXPECT_EQ(balance.escaped[band], 0.0);
        emitted += balance.emitted[band];
        ended += end;
    }
    EXPECT_NE(balance.roulette_surplus[kBand], 0.0);
    EXPECT_NEAR(ended / emitted, 1.0, 1e-10);
}

// A band among others has the mean that it has on its own.
TEST(LateRays, BandsThatScatterUnlikeDoNotDisturbEachOther) {
    BoxRoom together({5, 3, 4}, 0.3, 0.4);
    make_uneven(together.materials[0]);
    const std::vector<Vec3> listeners = {{3, 1.5, 2.5}};
    RayOptions options = options_for(0.2);
    options.rays = 60000;
    options.bin = 0.02;
    const auto energies_of = [&](const BoxRoom& room) {
        return trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options).listeners[0];
    };
    const audio::EnergyHistogram all = energies_of(together);
    for (const auto& [band, absorption, scattering] : {std::tuple{std::size_t{2}, 0.1, 0.05},
                                                       {std::size_t{5}, 0.3, 0.4},
                                                       {std::size_t{8}, 0.5, 0.9}}) {
        const audio::EnergyHistogram alone =
            energies_of(BoxRoom({5, 3, 4}, absorption, scattering));
        for (std::size_t n = 1; n < 8; ++n) {
            const double error = std::hypot(all.error[n][band], alone.error[n][band]);
            EXPECT_NEAR(all.energy[n][band], alone.energy[n][band], 4.0 * error)
                << "band " << band << ", interval " << n;
            EXPECT_LT(error, 0.2 * alone.energy[n][band]);
        }
    }
}

TEST(LateRays, DiffuseRoomsDecayAsEyringAndKuttruffSay) {
    struct Case {
        Vec3 size;
        double path_variance, tolerance;
    };
    // Variances of free paths: Kuttruff 2009, table 5.1.
    for (const Case& test : {Case{{6, 6, 6}, 0.34, 0.03}, Case{{8, 4, 6}, 0.40, 0.05}}) {
        for (const double absorption : {0.1, 0.3}) {
            const BoxRoom room(test.size, absorption, 1.0);
            const double expected = eyring_time(room, absorption, test.path_variance);
            const std::vector<Vec3> listeners = {0.6 * test.size};
            const LateEnergy late = trace_late_rays(
                room.scene(), source_at(0.3 * test.size), listeners, options_for(1.2 * expected));
            EXPECT_NEAR(decay_time(late.listeners[0]) / expected, 1.0, test.tolerance)
                << absorption;
        }
    }
}

/// Energy of all images of a box within a span of time, without scattering.
double image_energy(const BoxRoom& room,
                    const Vec3& source,
                    const Vec3& listener,
                    double reflected,
                    int min_order,
                    double from,
                    double to) {
    double sum = 0.0;
    constexpr int kMaxIndex = 30;
    for (int x = -kMaxIndex; x <= kMaxIndex; ++x) {
        for (int y = -kMaxIndex; y <= kMaxIndex; ++y) {
            for (int z = -kMaxIndex; z <= kMaxIndex; ++z) {
                const int n[3] = {x, y, z};
                Vec3 image;
                for (int k = 0; k < 3; ++k) {
                    image[k] = n[k] * room.size[k] +
                               (n[k] % 2 == 0 ? source[k] : room.size[k] - source[k]);
                }
                const double distance = glm::distance(image, listener);
                const int order = std::abs(x) + std::abs(y) + std::abs(z);
                const double time = distance / 343.2;
                if (order >= min_order && time >= from && time < to) {
                    sum += std::pow(reflected, order) / (distance * distance);
                }
            }
        }
    }
    return sum;
}

TEST(LateRays, MirrorsAloneGiveTheEnergyOfTheImagesPastTheOrderOfExactPaths) {
    const BoxRoom room({7, 4, 5}, 0.2, 0.0);
    const Vec3 source = {2, 1.5, 1.3};
    const Vec3 listener = {5, 2.2, 3.4};
    RayOptions options = options_for(0.4);
    options.rays = 60000;
    options.specular_order = 3;
    const LateEnergy late =
        trace_late_rays(room.scene(), source_at(source), std::vector<Vec3>{listener}, options);
    const std::vector<double> found = energies(late.listeners[0]);
    for (const auto& [from, to] : {std::pair(0.0, 0.05), {0.05, 0.1}, {0.1, 0.2}, {0.2, 0.3}}) {
        const double sum = std::accumulate(found.begin() + std::lround(from / options.bin),
                                           found.begin() + std::lround(to / options.bin),
                                           0.0);
        const double expected = image_energy(room, source, listener, 0.8, 4, from, to);
        EXPECT_NEAR(sum / expected, 1.0, 0.06) << from;
    }
}

TEST(LateRays, ErrorsTellHowFarRunsWithOtherSeedsDiffer) {
    const BoxRoom room({5, 3, 4}, 0.3, 0.5);
    const std::vector<Vec3> listeners = {{3, 1.5, 2.5}};
    constexpr int kSeeds = 12;
    constexpr std::size_t kBin = 4;  // of 10 ms
    double sum = 0.0, squares = 0.0, errors = 0.0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        RayOptions options = options_for(0.1);
        options.bin = 0.01;
        options.seed = seed;
        const LateEnergy late =
            trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options);
        const double energy = late.listeners[0].energy[kBin][kBand];
        sum += energy / kSeeds;
        squares += energy * energy / kSeeds;
        errors += late.listeners[0].error[kBin][kBand] / kSeeds;
    }
    const double spread = std::sqrt((squares - sum * sum) * kSeeds / (kSeeds - 1.0));
    EXPECT_LT(spread, 0.05 * sum);
    EXPECT_GT(errors, 0.3 * spread);
    EXPECT_LT(errors, 6.0 * spread);
}

TEST(LateRays, TheHistogramIsTheMeanOfItsReplicates) {
    const BoxRoom room({5, 3, 4}, 0.2, 0.3);
    const std::vector<Vec3> listeners = {{3, 1.5, 2.5}, {1, 2, 3}};
    RayOptions options = options_for(0.3);
    options.air_absorption = true;
    options.rays = 5000;
    const LateEnergy late = trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options);
    ASSERT_EQ(late.replicates.size(), listeners.size());
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        const audio::HistogramReplicates& replicates = late.replicates[k];
        ASSERT_EQ(replicates.energy.size(), 4U);
        for (std::size_t i = 0; i + 1 < replicates.first_bin.size(); ++i) {
            for (std::size_t band = 0; band < options.bands.count(); ++band) {
                double expected = 0.0, mean = 0.0;
                for (std::size_t n = replicates.first_bin[i]; n < replicates.first_bin[i + 1];
                     ++n) {
                    expected += late.listeners[k].energy[n][band];
                }
                for (const auto& energy : replicates.energy) {
                    mean += energy[i][band] / 4.0;
                }
                ASSERT_NEAR(mean, expected, 1e-12 * expected) << band << ", interval " << i;
            }
        }
    }
}

TEST(LateRays, TheResultDoesNotDependOnTheThreads) {
    const BoxRoom room({5, 3, 4}, 0.2, 0.3);
    // The last two near an edge and in a corner.
    const std::vector<Vec3> listeners = {
        {3, 1.5, 2.5}, {1, 2, 3}, {4.9, 0.1, 2}, {0.001, 2.999, 3.999}};
    RayOptions options = options_for(0.3);
    options.rays = 5000;
    const auto digest_of = [&](int threads) {
        Executor executor(threads);
        const LateEnergy late =
            trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options, executor);
        Digest digest;
        for (const auto& histogram : late.listeners) {
            for (std::size_t n = 0; n < histogram.energy.size(); ++n) {
                digest.add(histogram.energy[n][kBand]);
                digest.add(histogram.error[n][kBand]);
            }
        }
        digest.add(late.balance.absorbed[kBand]);
        return digest.value();
    };
    EXPECT_EQ(digest_of(2), digest_of(1));
    EXPECT_EQ(digest_of(8), digest_of(1));
}

/// A room in which T30 takes many rays: nothing scatters.
LateEnergy until_certain(const BoxRoom& room,
                         const std::vector<Vec3>& listeners,
                         double max_error,
                         int threads = 2) {
    RayOptions options = options_for(1.5);
    options.rays = 400000;
    options.bin = 0.005;
    options.max_error = max_error;
    Executor executor(threads);
    return trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options, executor);
}

TEST(LateRays, BatchesEndWhereTheErrorsAreSmall) {
    const BoxRoom room({5, 3, 4}, 0.2, 0.0);
    const std::vector<Vec3> listeners = {{3, 1.5, 2.5}, {4.9, 2.9, 3.9}};
    const LateEnergy loose = until_certain(room, listeners, 0.05);
    const LateEnergy tight = until_certain(room, listeners, 0.005);
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        EXPECT_TRUE(loose.errors[k].reached);
        EXPECT_LE(1.3 * loose.errors[k].t30, 0.05);
        EXPECT_LE(1.3 * loose.errors[k].level_db, 0.25);
        EXPECT_GE(tight.errors[k].rays, loose.errors[k].rays);
        EXPECT_EQ(loose.errors[k].rays % 2048, 0U);
        // Of both runs the first batches are the same: the results differ by chance alone.
        EXPECT_NEAR(decay_time(loose.listeners[k]) / decay_time(tight.listeners[k]), 1.0, 0.1);
    }
    EXPECT_GT(tight.errors[1].rays, 32U * 1024U);
}

// Where a search ends decides how many batches there are, not which.
TEST(LateRays, TheBatchesOfALooserTargetAreTheFirstOfATighterOnes) {
    const BoxRoom room({5, 3, 4}, 0.2, 0.1);
    const std::vector<Vec3> listeners = {{4.99, 1.5, 2.5}};
    RayOptions options = options_for(0.8);
    options.bin = 0.005;
    options.rays = 256 * 2048;
    options.max_error = 0.01;
    Executor executor(2);
    const auto traced = [&] {
        return trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options, executor);
    };
    const LateEnergy loose = traced();
    options.max_error = 1e-6;
    for (const std::size_t batches : {16, 32, 48, 64, 96, 128}) {
        if (loose.errors[0].rays != batches * 2048) {
            continue;
        }
        options.rays = batches * 2048;
        const LateEnergy tight = traced();
        EXPECT_FALSE(tight.errors[0].reached);
        EXPECT_EQ(tight.listeners[0].energy, loose.listeners[0].energy);
        EXPECT_EQ(tight.replicates[0].energy, loose.replicates[0].energy);
        return;
    }
    FAIL() << loose.errors[0].rays;
}

TEST(LateRays, AListenersEndDependsOnNoOtherListenerAndNoThread) {
    const BoxRoom room({5, 3, 4}, 0.2, 0.1);
    const std::vector<Vec3> listeners = {{3, 1.5, 2.5}, {4.9, 2.9, 3.9}};
    const LateEnergy together = until_certain(room, listeners, 0.02, 8);
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        const LateEnergy alone = until_certain(room, {listeners[k]}, 0.02, 1);
        EXPECT_EQ(alone.errors[0].rays, together.errors[k].rays);
        EXPECT_EQ(alone.listeners[0].energy, together.listeners[k].energy);
        EXPECT_EQ(alone.listeners[0].reflection_growth, together.listeners[k].reflection_growth);
    }
}

TEST(LateRays, TellsWhatTheMostRaysDidNotReach) {
    const BoxRoom room({5, 3, 4}, 0.2, 0.0);
    RayOptions options = options_for(1.5);
    options.rays = 40000;
    options.max_error = 1e-4;
    const std::vector<Vec3> listeners = {{4.9, 2.9, 3.9}};
    const LateErrors errors =
        trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options).errors[0];
    EXPECT_FALSE(errors.reached);
    EXPECT_EQ(errors.rays, 40000U / 2048U * 2048U);
    EXPECT_GT(errors.t30, 1e-4);
}

// Over many seeds the deviations, in units of the errors, have the standard deviation 1.
TEST(SlowLateRays, ErrorsOfDecayAndLevelAreHonest) {
    const BoxRoom room({5, 3, 4}, 0.4, 0.2);
    const std::vector<Vec3> listeners = {{3, 1.5, 2.5}, {4.9, 2.9, 3.9}, {4.99, 1.5, 2}};
    constexpr int kSeeds = 50;
    struct Value {
        double value, error;
    };
    std::vector<std::vector<Value>> times(listeners.size()), levels(listeners.size());
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        RayOptions options = options_for(0.35);
        options.seed = seed;
        options.bin = 0.005;
        options.rays = 32 * 2048;
        options.decay_time = 0.25;
        Executor executor(2);
        const LateEnergy late =
            trace_late_rays(room.scene(), source_at({1, 1, 1}), listeners, options, executor);
        for (std::size_t k = 0; k < listeners.size(); ++k) {
            const std::vector<double> energy = energies(late.listeners[k]);
            const double time = decay_time(late.listeners[k]);
            times[k].push_back({time, late.errors[k].t30 * time});
            levels[k].push_back(
                {10.0 * std::log10(std::accumulate(energy.begin(), energy.end(), 0.0)),
                 late.errors[k].level_db});
        }
    }
    // Root mean square of the deviations over the errors, pooled.
    const auto ratio_of = [](const std::vector<std::vector<Value>>& listeners_values) {
        double squares = 0.0, count = 0.0;
        for (const std::vector<Value>& values : listeners_values) {
            double mean = 0.0;
            for (const Value& value : values) {
                mean += value.value / kSeeds;
            }
            for (const Value& value : values) {
                squares += std::pow((value.value - mean) / value.error, 2.0);
            }
            count += kSeeds - 1.0;
        }
        return std::sqrt(squares / count);
    };
    EXPECT_GT(ratio_of(times), 0.8);
    EXPECT_LT(ratio_of(times), 1.25);
    EXPECT_GT(ratio_of(levels), 0.8);
    EXPECT_LT(ratio_of(levels), 1.25);
}

// Each band decays by its own absorption, as its images say.
TEST(LateRays, EveryBandHasTheEnergyOfItsImages) {
    BoxRoom room({7, 4, 5}, 0.2, 0.0);
    std::vector<EnergyCoefficient::Point> points;
    RayOptions options = options_for(0.3);
    options.rays = 60000;
    options.bin = 0.05;
    options.specular_order = 2;
    for (std::size_t band = 0; band < options.bands.count(); ++band) {
        points.push_back(
            {options.bands.nominal_hz()[band], 0.1 + 0.05 * static_cast<double>(band)});
    }
    room.materials[0].absorption = EnergyCoefficient(points);
    const Vec3 source = {2, 1.5, 1.3}, listener = {5, 2.2, 4.9};
    const audio::EnergyHistogram histogram =
        trace_late_rays(room.scene(), source_at(source), std::vector<Vec3>{listener}, options)
            .listeners[0];
    for (std::size_t band = 0; band < options.bands.count(); ++band) {
        double whole = 0.0, found = 0.0;
        for (std::size_t n = 0; n < histogram.energy.size(); ++n) {
            const double from = static_cast<double>(n) * options.bin;
            const double expected = image_energy(
                room, source, listener, 1.0 - points[band].value, 3, from, from + options.bin);
            whole += expected;
            found += histogram.energy[n][band];
            EXPECT_NEAR(
                histogram.energy[n][band], expected, 4.0 * histogram.error[n][band] + 2e-3 * whole)
                << band << ", interval " << n;
        }
        EXPECT_NEAR(found / whole, 1.0, 0.01) << band;
    }
}

// In a cube that scatters everything, late sound comes from everywhere about alike, also to a
// listener near a wall that reflects like the others: sound from the far wall is older, and so up
// to 4 % stronger than the mean.
TEST(LateRays, ADiffuseFieldComesFromEverywhere) {
    const BoxRoom room({6, 6, 6}, 0.05, 1.0);
    RayOptions options = options_for(0.5);
    options.rays = 60000;
    options.report_directions = true;
    Executor executor(2);
    const LateEnergy late = trace_late_rays(room.scene(),
                                            source_at({2, 2.5, 1.7}),
                                            std::vector<Vec3>{{3, 3, 3}, {3, 0.01, 3}},
                                            options,
                                            executor);
    for (const audio::EnergyHistogram& histogram : late.listeners) {
        std::array<double, audio::kDirectionParts> parts{};
        double all = 0.0;
        constexpr std::size_t kFirst = 5;  // 100 ms
        for (std::size_t n = kFirst; n < histogram.directions.size(); ++n) {
            for (std::size_t part = 0; part < parts.size(); ++part) {
                parts[part] += histogram.directions[n][part][kBand];
                all += histogram.directions[n][part][kBand];
            }
        }
        for (const double part : parts) {
            EXPECT_NEAR(part / all * audio::kDirectionParts, 1.0, 0.06);
        }
    }
}

TEST(LateRays, RefusesOptionsOutOfRange) {
    const BoxRoom room({5, 3, 4}, 0.2, 0.3);
    const auto attempt = [&](const RayOptions& options) {
        trace_late_rays(room.scene(), source_at({1, 1, 1}), {}, options);
    };
    EXPECT_THROW(attempt({.rays = 0}), Error);
    EXPECT_THROW(attempt({.length = -1.0}), Error);
    EXPECT_THROW(attempt({.bin = 0.0}), Error);
    EXPECT_THROW(attempt({.receiver_radius = -1.0}), Error);
    EXPECT_THROW(attempt({.max_error = -0.01}), Error);
}

// Listeners far from the walls, where rain falls by chance if its radius is small.
TEST(LateRays, RainThatFallsByChanceHasTheSameMean) {
    const BoxRoom room({8, 3.5, 6}, 0.2, 0.7);
    const std::vector<Vec3> listeners = {{2.5, 1.4, 2}, {6, 1.7, 4.5}, {4, 1.2, 3}};
    RayOptions options = options_for(0.6);
    options.rays = 60000;
    const LateEnergy everywhere =
        trace_late_rays(room.scene(), source_at({5, 1.6, 2}), listeners, options);
    options.rain_radius = 1.5;
    options.seed = 2;
    const LateEnergy by_chance =
        trace_late_rays(room.scene(), source_at({5, 1.6, 2}), listeners, options);
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        const auto level = [&](const LateEnergy& late) {
            const std::vector<double> all = energies(late.listeners[k]);
            return 10.0 * std::log10(std::accumulate(all.begin(), all.end(), 0.0));
        };
        const double error =
            std::hypot(everywhere.errors[k].level_db, by_chance.errors[k].level_db);
        EXPECT_LT(error, 0.1);
        EXPECT_NEAR(level(everywhere), level(by_chance), 4.0 * error);
        // The rays' own variance is the larger part.
        EXPECT_LT(by_chance.errors[k].level_db, 2.0 * everywhere.errors[k].level_db);
    }
    // Nor does it matter who else listens.
    const LateEnergy alone = trace_late_rays(
        room.scene(), source_at({5, 1.6, 2}), std::span(listeners).subspan(1, 1), options);
    EXPECT_EQ(energies(alone.listeners[0]), energies(by_chance.listeners[1]));
}

/// A room whose ceiling absorbs nearly all: late sound keeps to the walls.
struct RoomWithAbsorbingCeiling : BoxRoom {
    RoomWithAbsorbingCeiling() : BoxRoom({8, 3, 6}, 0.05, 0.2) {
        materials.push_back(materials[0]);
        materials[1].absorption = EnergyCoefficient(0.9);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto& [a, b, c] = mesh.triangles[i];
            if (std::min({mesh.positions[a].y, mesh.positions[b].y, mesh.positions[c].y}) > 2.9) {
                material_of_triangle[i] = 1;
            }
        }
    }
};

// Against the same number of rays without a window, in the energy of parts of the decay.
TEST(LateRays, AWeightWindowKeepsTheMeanAndTellsMoreOfTheDecay) {
    const RoomWithAbsorbingCeiling room;
    const std::vector<Vec3> listeners = {{2.5, 1.4, 2}, {6, 1.7, 4.5}, {7.8, 1.2, 3}};
    RayOptions options = options_for(0.8);
    options.rays = 40000;
    const LateEnergy plain =
        trace_late_rays(room.scene(), source_at({5, 1.6, 2}), listeners, options);
    options.weight_window = true;
    options.seed = 2;
    const auto trace = [&](std::span<const Vec3> to, int threads) {
        Executor executor(threads);
        return trace_late_rays(room.scene(), source_at({5, 1.6, 2}), to, options, executor);
    };
    const LateEnergy window = trace(listeners, 2);
    const EnergyBalance& balance = window.balance;
    EXPECT_NEAR((balance.absorbed[kBand] + balance.escaped[kBand] + balance.remaining[kBand]) /
                    balance.emitted[kBand],
                1.0,
                1e-10);
    for (std::size_t k = 0; k < listeners.size(); ++k) {
        for (const double begin : {0.0, 0.1, 0.25}) {
            const auto sum_and_error = [&](const audio::HistogramReplicates& replicates) {
                std::vector<double> sums;
                for (const auto& replicate : replicates.energy) {
                    sums.push_back(0.0);
                    for (std::size_t n = 0; n < replicate.size(); ++n) {
                        const double time =
                            options.bin * static_cast<double>(replicates.first_bin[n]);
                        sums.back() += time >= begin ? replicate[n][kBand] : 0.0;
                    }
                }
                const double mean = std::accumulate(sums.begin(), sums.end(), 0.0) /
                                    static_cast<double>(sums.size());
                return std::pair(mean, standard_error_of_mean(sums));
            };
            const auto [expected, its_error] = sum_and_error(plain.replicates[k]);
            const auto [mean, error] = sum_and_error(window.replicates[k]);
            EXPECT_NEAR(mean, expected, 4.0 * std::hypot(error, its_error)) << begin;
        }
        EXPECT_LT(window.errors[k].t30, plain.errors[k].t30);
    }
    // Nor does it matter who else listens, or how many threads trace.
    const LateEnergy alone = trace(std::span(listeners).subspan(1, 1), 1);
    EXPECT_EQ(energies(alone.listeners[0]), energies(window.listeners[1]));
    EXPECT_EQ(alone.balance.absorbed, balance.absorbed);
}

}  // namespace
}  // namespace earshot::propagation
