// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/instant_broad_phase.h"
#include "earshot/collision/broad_phase/internal/swept_broad_phase.h"
#include "earshot/collision/convex.h"
#include "earshot/collision/internal/instant_search.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/internal/scene_meshes.h"
#include "earshot/collision/world.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::collision {

/// The meshes of a scene, which are those of the world from `first_mesh` on.
struct AddedScene {
    SceneMeshes meshes;
    std::uint32_t first_mesh;
};

/// The contacts of two meshes, with the poses in which they are.
struct PairContacts {
    MeshPair pair{};
    std::array<std::uint64_t, 2> poses{};
    InstantContacts contacts{};
};

struct World::State {
    MovingScene scene;
    std::vector<AddedScene> added;
    WorldStatistics statistics;

    // Of the last set_step(); a step on screws may be searched in parts.
    double t0 = 0.0, t1 = 0.0;
    Path path = Path::chords;
    std::size_t parts_of_step = 1;

    SweptBroadPhase swept;
    InstantBroadPhase instant;
    std::vector<PairContacts> pair_contacts;                     // of the last instant, ascending
    std::vector<std::uint8_t> representatives, all;              // see representatives.h
    std::uint64_t representatives_layout = 0;                    // of the scene that they are of
    std::vector<std::optional<std::vector<ConvexPart>>> convex;  // where they were asked for

    void move(std::uint32_t mesh,
              std::span<const geometry::Vec3> begin,
              std::span<const geometry::Vec3> end);
    void move(std::uint32_t mesh, std::span<const geometry::Vec3> begin, const Screw& screw);
    /// Moves the meshes of scenes between the ends of a part of the step.
    void move_to_part(std::size_t part);
    /// A time within a part as one within the step, rounded down: never late.
    double time_within_step(std::size_t part, double toi) const noexcept {
        return (static_cast<double>(part) + toi) / static_cast<double>(parts_of_step) *
               (1.0 - 0x1p-50);
    }

    /// The contacts of the step as it stands, sorted, each once. Adds to the statistics.
    std::vector<Contact> search(const ContactOptions& options, Executor& executor);

    /// The first of search().
    std::optional<Contact> search_first(const ContactOptions& options, Executor& executor);

    /// The contacts of all pairs of meshes at the beginning of the step, in any order. Adds to the
    /// statistics.
    std::vector<Contact> search_at_begin(const ContactOptions& options, Executor& executor);

    std::span<const ConvexPart> convex_parts_at_begin(std::uint32_t mesh);
    Contact contact_at_begin(std::uint32_t mesh_a, std::uint32_t mesh_b, TrianglePair pair) const;

private:
    void note_update(std::uint32_t mesh, bool has_moved);
    /// Runs both phases, in rounds of so many tasks: `new_tester` may set the testers of a round
    /// up, finish(tester) takes them in order.
    template <typename SetUp, typename Finish>
    void test_step(const ContactOptions& options,
                   std::size_t round,
                   Executor& executor,
                   SetUp&& set_up,
                   Finish&& finish);
    InstantContacts contacts_of_pair(const MeshPair& pair, Executor& executor) const;
    /// Finds the pair_contacts of these pairs, ascending.
    void search_pairs(std::span<const MeshPair> pairs, Executor& executor);
};

}  // namespace earshot::collision
