// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/collision/broad_phase/internal/bvtt_front.h"
#include "earshot/collision/broad_phase/internal/leaf_slabs.h"
#include "earshot/collision/broad_phase/internal/normal_cones.h"
#include "earshot/collision/broad_phase/internal/swept_bvh.h"
#include "earshot/collision/convex.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/internal/scene_meshes.h"
#include "earshot/collision/world.h"

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

/// What is kept of a mesh at the beginning of the step, where it was asked for.
struct MeshAtBegin {
    Shape shape;
    bool has_shape = false;         ///< of this topology
    bool is_shape_current = false;  ///< refitted to the present positions
    std::optional<std::vector<ConvexPart>> convex_parts;
};

struct World::State {
    MovingScene scene;
    std::vector<AddedScene> added;
    std::vector<MeshAtBegin> at_begin;
    WorldStatistics statistics;

    // Of the last set_step(); a step on screws may be searched in parts.
    double t0 = 0.0, t1 = 0.0;
    Path path = Path::chords;
    std::size_t parts_of_step = 1;

    // The broad phase.
    bvh::Builder builder = bvh::Builder::binned_sah;
    SweptBvh swept_bvh;
    LeafSlabs leaf_slabs;
    NormalCones normal_cones;
    bool has_normal_cones = false;  // whether they were built for the present tree
    BvttFront front;
    std::vector<std::uint8_t> representatives, all;  // see representatives.h

    void move(std::uint32_t mesh,
              std::span<const geometry::Vec3> begin,
              std::span<const geometry::Vec3> end);
    void move(std::uint32_t mesh, std::span<const geometry::Vec3> begin, const Screw& screw);
    /// Moves the meshes of scenes between the ends of a part of the step.
    void move_to_part(std::size_t part);

    /// The contacts of the step as it stands, sorted, each once. Adds to the statistics.
    std::vector<Contact> search(const ContactOptions& options, Executor& executor);

    const Shape& shape_at_begin(std::uint32_t mesh, Executor& executor);
    std::span<const ConvexPart> convex_parts_at_begin(std::uint32_t mesh);
    Contact contact_at_begin(std::uint32_t mesh_a, std::uint32_t mesh_b, TrianglePair pair) const;

private:
    void set_begin(std::uint32_t mesh, std::span<const geometry::Vec3> positions);
    void update_broad_phase(const ContactOptions& options, Executor& executor);
    const NormalCones* normal_cones_for(const ContactOptions& options, Executor& executor);
};

}  // namespace earshot::collision
