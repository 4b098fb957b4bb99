// SPDX-License-Identifier: MIT
// Walls that a file holds twice, nearer to each other than the rounding of its coordinates, reflect
// like single ones. The oracle searches the single walls.
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/air.h"
#include "support/compare_with_oracle.h"
#include "support/random_rooms.h"
#include "support/shoebox_images.h"
#include "support/traced_room.h"
#include <array>
#include <cmath>
#include <iostream>
#include <map>
#include <vector>

namespace earshot::support {
namespace {

using geometry::Vec3;

enum class Copy { plain, split };

/// Adds a copy of every wall, moved along its normal by `gap(label)` metres. A split copy has three
/// triangles for one, so that only its plane tells that it is a copy.
template <typename Gap>
Room with_doubled_walls(const Room& room, Copy copy, Gap&& gap) {
    Room result = room;
    for (std::size_t t = 0; t < room.mesh.triangles.size(); ++t) {
        const auto [a, b, c] = room.mesh.triangles[t];
        std::array<Vec3, 3> p = {
            room.mesh.positions[a], room.mesh.positions[b], room.mesh.positions[c]};
        const Vec3 normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
        for (Vec3& corner : p) {
            corner += gap(room.labels[t]) * normal;
        }
        const bool is_sheet = room.is_sheet[t] != 0;
        if (copy == Copy::plain) {
            add_triangle(result, p, room.labels[t], is_sheet);
            continue;
        }
        const Vec3 middle = (p[0] + p[1] + p[2]) / 3.0;
        for (std::size_t k = 0; k < 3; ++k) {
            add_triangle(result, {p[k], p[(k + 1) % 3], middle}, room.labels[t], is_sheet);
        }
    }
    return result;
}

TEST(CoincidentWalls, ABoxStoredTwiceHasThePathsOfOne) {
    const Vec3 lower(0.0), upper = {8.0, 3.5, 6.0};
    const Vec3 source = {2.0, 1.2, 1.5};
    const Vec3 listener = {5.5, 1.6, 4.0};
    const Room room = box_room(lower, upper);
    for (const Copy copy : {Copy::plain, Copy::split}) {
        for (const double size : {1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 3e-6, 5e-6, 1e-5}) {
            for (const double side : {1.0, -1.0}) {
                const Room doubled =
                    with_doubled_walls(room, copy, [&](std::uint32_t) { return side * size; });
                const auto paths = TracedRoom(doubled).paths(source, listener, {.max_order = 4});
                EXPECT_EQ(paths.size(), 129U) << "gap " << side * size;
                EXPECT_EQ(disagreement(facts_of(paths, doubled.labels),
                                       shoebox_images(lower, upper, source, listener, 4),
                                       1e-5),
                          "")
                    << "gap " << side * size;
            }
        }
    }
}

// A copy moved as a whole: some of its walls lie before those of the first, some behind.
TEST(CoincidentWalls, ABoxMovedByRoundingHasThePathsOfOne) {
    const Vec3 lower(0.0), upper = {8.0, 3.5, 6.0};
    const Vec3 source = {2.0, 1.2, 1.5};
    const Vec3 listener = {5.5, 1.6, 4.0};
    for (const double shift : {1e-12, 1e-9, 3e-7, 1.5e-6, 4e-6}) {
        Room doubled = box_room(lower, upper);
        const Room copy = tessellated_box_room(lower + Vec3(shift, -0.7 * shift, 0.9 * shift),
                                               upper + Vec3(shift, -0.7 * shift, 0.9 * shift),
                                               2);
        for (std::size_t t = 0; t < copy.mesh.triangles.size(); ++t) {
            const auto [a, b, c] = copy.mesh.triangles[t];
            add_triangle(doubled,
                         {copy.mesh.positions[a], copy.mesh.positions[b], copy.mesh.positions[c]},
                         copy.labels[t]);
        }
        const auto paths = TracedRoom(doubled).paths(source, listener, {.max_order = 4});
        EXPECT_EQ(paths.size(), 129U) << "shift " << shift;
        EXPECT_EQ(disagreement(facts_of(paths, doubled.labels),
                               shoebox_images(lower, upper, source, listener, 4),
                               1e-5),
                  "")
            << "shift " << shift;
    }
}

TEST(SlowCoincidentWalls, RandomRoomsWithDoubledWallsHaveThePathsOfSingleOnes) {
    constexpr std::uint64_t kRooms = 210;
    constexpr int kOrder = 3;
    Comparison total;
    for (std::uint64_t seed = 0; seed < kRooms; ++seed) {
        const Room room = random_room(seed);
        Dice dice(seed ^ 0xd0b1eULL);
        const Vec3 source = random_air_point(room, dice);
        std::vector<Vec3> listeners;
        for (int i = 0; i < 3; ++i) {
            listeners.push_back(random_air_point(room, dice));
        }
        std::map<std::uint32_t, double> gaps;
        for (const std::uint32_t label : room.labels) {
            const double size = std::pow(10.0, dice.between(-12.0, -6.0));
            gaps.emplace(label, dice.chance(0.5) ? size : -size);
        }
        const Room doubled = with_doubled_walls(room,
                                                seed % 2 == 0 ? Copy::split : Copy::plain,
                                                [&](auto label) { return gaps.at(label); });
        // Decisions that the gaps may turn are not decided; paths that they may lengthen agree.
        const OracleResult oracle =
            search_image_sources(room.mesh.view(),
                                 room.labels,
                                 source,
                                 listeners,
                                 {.max_order = kOrder, .ambiguity_margin = 2e-5});
        const Comparison comparison =
            compare_paths(TracedRoom(doubled).trace(source, listeners, {.max_order = kOrder}).paths,
                          oracle,
                          doubled.mesh,
                          {.length = 2e-5, .point = 1e-3});
        EXPECT_EQ(
            comparison.missed + comparison.false_paths + comparison.doubled + comparison.misnamed,
            0U)
            << "seed " << seed << ", " << room.kind << "\n"
            << comparison.details;
        total += comparison;
    }
    std::cout << "doubled walls: " << total.expected << " paths expected, " << total.found
              << " found, " << total.missed << " missed, " << total.false_paths << " false, "
              << total.doubled << " doubled, " << total.ambiguous << " ambiguous\n";
    EXPECT_GT(total.expected, 10 * kRooms);
}

}  // namespace
}  // namespace earshot::support
