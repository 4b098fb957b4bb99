// SPDX-License-Identifier: MIT
// Specular paths in random rooms against the brute-force search. Every failure names its seed;
// kFirstSeed and the counts choose the rooms.
#include "support/random_rooms.h"

#include <gtest/gtest.h>

#include "support/air.h"
#include "support/compare_with_oracle.h"
#include "support/traced_room.h"
#include <iostream>
#include <vector>

namespace earshot::support {
namespace {

constexpr std::uint64_t kFirstSeed = 0;
constexpr std::uint64_t kRooms = 210;     // thirty of each family
constexpr std::uint64_t kDeepRooms = 70;  // of these, as many are searched one order deeper
constexpr int kOrder = 3;
constexpr int kDeepOrder = 4;
constexpr std::size_t kDeepTriangles = 80;  // at most: the search is exponential in the order
constexpr int kListeners = 2;               // anywhere
constexpr int kAimedListeners = 4;          // where a decision is close

struct Question {
    Room room{};
    geometry::Vec3 source{};
    std::vector<geometry::Vec3> listeners{};
};

Question question(std::uint64_t seed) {
    Question result;
    result.room = random_room(seed);
    Dice dice(seed ^ 0x5eedULL);
    result.source = random_air_point(result.room, dice);
    for (int i = 0; i < kListeners; ++i) {
        result.listeners.push_back(random_air_point(result.room, dice));
    }
    for (int i = 0; i < kAimedListeners; ++i) {
        result.listeners.push_back(aimed_air_point(result.room, result.source, dice));
    }
    return result;
}

Comparison compare(const Question& asked, int max_order, frustum::Mode mode) {
    return compare_with_oracle(asked.room.mesh,
                               asked.room.labels,
                               asked.source,
                               asked.listeners,
                               {.trace = {.max_order = max_order, .mode = mode}});
}

void report(const Comparison& total, const char* what) {
    std::cout << what << ": " << total.expected << " paths expected, " << total.found << " found, "
              << total.missed << " missed, " << total.false_paths << " false, " << total.doubled
              << " doubled, " << total.misnamed << " misnamed, " << total.ambiguous
              << " ambiguous\n";
}

void expect_same(const Comparison& comparison, std::uint64_t seed, const Room& room) {
    EXPECT_TRUE(
        comparison.missed + comparison.false_paths + comparison.doubled + comparison.misnamed == 0)
        << "seed " << seed << ", " << room.kind << ", " << room.mesh.triangles.size()
        << " triangles: " << comparison.missed << " missed, " << comparison.false_paths
        << " false, " << comparison.doubled << " doubled, " << comparison.misnamed
        << " misnamed of " << comparison.expected << "\n"
        << comparison.details;
}

TEST(SlowRandomRooms, CompleteModeFindsWhatBruteForceFinds) {
    Comparison total;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kRooms; ++seed) {
        const Question asked = question(seed);
        const Comparison comparison = compare(asked, kOrder, frustum::Mode::complete);
        expect_same(comparison, seed, asked.room);
        total += comparison;
    }
    report(total, "random rooms, order 3");
    // A comparison of nothing with nothing would pass as well.
    EXPECT_GT(total.expected, 10 * kRooms);
}

TEST(SlowRandomRooms, CompleteModeFindsTheSameOneOrderDeeper) {
    Comparison total;
    std::uint64_t rooms = 0;
    for (std::uint64_t seed = kFirstSeed; rooms < kDeepRooms; ++seed) {
        const Question asked = question(seed);
        if (asked.room.mesh.triangles.size() > kDeepTriangles) {
            continue;
        }
        ++rooms;
        const Comparison comparison = compare(asked, kDeepOrder, frustum::Mode::complete);
        expect_same(comparison, seed, asked.room);
        total += comparison;
    }
    report(total, "random rooms, order 4");
    EXPECT_GT(total.expected, 10 * kDeepRooms);
}

TEST(SlowRandomRooms, SampledModeNeverInventsOrRepeatsAPath) {
    constexpr std::uint64_t kSampledRooms = 2 * kRoomFamilies;
    Comparison total;
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSampledRooms; ++seed) {
        const Question asked = question(seed);
        const Comparison comparison = compare(asked, kOrder, frustum::Mode::sampled);
        EXPECT_TRUE(comparison.false_paths + comparison.doubled + comparison.misnamed == 0)
            << "seed " << seed << ", " << asked.room.kind << "\n"
            << comparison.details;
        total += comparison;
    }
    report(total, "random rooms, sampled");
    EXPECT_GT(total.found, 0U);
}

TEST(SlowRandomRooms, ResolutionChangesTheTimeOnly) {
    for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kRoomFamilies; ++seed) {
        const Question asked = question(seed);
        const TracedRoom room(asked.room);
        const auto paths = room.trace(asked.source, asked.listeners, {.max_order = 2}).paths;
        for (const int resolution : {1, 3, 16}) {
            EXPECT_EQ(room.trace(asked.source,
                                 asked.listeners,
                                 {.max_order = 2, .resolution = resolution, .box_lattice = false})
                          .paths,
                      paths)
                << "seed " << seed << ", resolution " << resolution;
        }
    }
}

}  // namespace
}  // namespace earshot::support
