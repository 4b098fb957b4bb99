// SPDX-License-Identifier: MIT
// The project's scenes against the brute-force search: rooms with furniture, an opening, balconies.
#include "earshot/io/scene_file.h"
#include "earshot/scenes/gltf_writer.h"
#include "earshot/scenes/models.h"

#include <gtest/gtest.h>

#include "support/compare_with_oracle.h"
#include "support/temporary_folder.h"
#include <iostream>

namespace earshot::support {
namespace {

// Positions are stored as floats, so facets are plane and points lie on them to a micrometre or
// two, and a decision closer than that is open.
constexpr PathTolerance kStoredAsFloats = {.length = 2e-5, .point = 2e-4};
constexpr double kOpenDecision = 2e-5;

propagation::Scene load(const scenes::SceneDraft& draft) {
    const test::TemporaryFolder folder;
    return io::load_scene(folder.file(draft.name + ".gltf",
                                      scenes::write_gltf(draft, scenes::GltfForm::text, 1).bytes))
        .scene;
}

/// Compares every source with all listeners.
Comparison compare(const scenes::SceneDraft& draft, int order) {
    const propagation::Scene scene = load(draft);
    const geometry::Mesh mesh{scene.mesh.positions_at(0.0), scene.mesh.triangles()};
    std::vector<geometry::Vec3> listeners;
    for (const propagation::Emitter& listener : scene.listeners) {
        listeners.push_back(scene.position_at(listener, 0.0));
    }
    CompareOptions options;
    options.trace.max_order = order;
    options.oracle.ambiguity_margin = kOpenDecision;
    options.tolerance = kStoredAsFloats;
    Comparison total;
    for (const propagation::Emitter& source : scene.sources) {
        total += compare_with_oracle(
            mesh, scene.material_of_triangle, scene.position_at(source, 0.0), listeners, options);
    }
    std::cout << draft.name << ", order " << order << ": " << total.expected << " paths expected, "
              << total.found << " found, " << total.missed << " missed, " << total.false_paths
              << " false, " << total.doubled << " doubled, " << total.ambiguous << " open\n";
    return total;
}

void expect_all_found(const Comparison& comparison) {
    EXPECT_GT(comparison.expected, 50U);
    EXPECT_EQ(comparison.missed, 0U) << comparison.details;
    EXPECT_EQ(comparison.false_paths, 0U) << comparison.details;
    EXPECT_EQ(comparison.doubled, 0U) << comparison.details;
}

TEST(SlowScenes, CoupledRooms) {
    expect_all_found(compare(scenes::make_coupled_rooms(), 3));
}

TEST(SlowScenes, Classroom) {
    expect_all_found(compare(scenes::make_classroom(), 3));
}

// Blocks of seats instead of single ones: a few hundred facets, which the search can exhaust.
TEST(SlowScenes, ConcertHall) {
    expect_all_found(compare(scenes::make_concert_hall({.seats = scenes::Seats::blocks}), 3));
}

// With every seat, one order less.
TEST(SlowScenes, ConcertHallWithEverySeat) {
    expect_all_found(compare(scenes::make_concert_hall(), 2));
}

}  // namespace
}  // namespace earshot::support
