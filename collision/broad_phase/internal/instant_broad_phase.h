// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/collision/broad_phase/internal/bvtt_front.h"
#include "earshot/collision/contact_options.h"
#include "earshot/collision/internal/moving_scene.h"
#include "earshot/collision/shape.h"
#include "earshot/collision/statistics.h"

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::collision {

/// Two meshes, a <= b.
struct MeshPair {
    std::uint32_t a = 0, b = 0;

    friend auto operator<=>(const MeshPair&, const MeshPair&) = default;
};

/// The broad phase at an instant, the beginning of a step: an upper tree over the meshes, which
/// finds those whose boxes overlap, and a shape of each mesh that needs one. All is kept, and
/// follows the meshes that move.
class InstantBroadPhase {
public:
    explicit InstantBroadPhase(bvh::Builder builder = bvh::Builder::binned_sah)
        : builder_(builder) {}

    /// To be called at every instant of a mesh: whether it is somewhere else than before. A mesh
    /// at rest keeps its shape, but for some instants after it has moved.
    void note_update(std::uint32_t mesh, bool has_moved);

    /// Grows whenever a mesh has moved. Precondition: mesh_pairs() since it was added.
    std::uint64_t pose(std::uint32_t mesh) const noexcept { return kept_[mesh].pose; }

    /// The pairs of meshes that the options accept and whose boxes overlap, ascending.
    std::vector<MeshPair> mesh_pairs(const MovingScene& scene,
                                     const ContactOptions& options,
                                     Executor& executor,
                                     WorldStatistics& statistics);

    /// Brings the shapes of meshes to where they are, building those that there are not yet. Counts
    /// what it did to trees. Throws what Shape::build() does.
    void update_shapes(const MovingScene& scene,
                       std::span<const std::uint32_t> meshes,
                       Executor& executor,
                       WorldStatistics& statistics);

    /// Precondition: update_shapes() with this mesh since it was moved last.
    const Shape& shape(std::uint32_t mesh) const noexcept { return kept_[mesh].shape; }

    /// Tells what a query of a mesh's shape took.
    void add_work(std::uint32_t mesh, const WorldStatistics& work) noexcept;

private:
    struct KeptMesh {
        geometry::Aabb bounds{};
        Shape shape{};
        bool has_shape = false;
        bool is_shape_current = false;
        bool are_bounds_current = false;
        std::uint64_t pose = 0;
        int instants_to_settle = 0;  // updates of the shape to come while the mesh rests
        double node_visits = 0.0;    // of the shape since it was updated
    };

    void follow_layout(const MovingScene& scene);
    void update_upper_tree(const MovingScene& scene,
                           Executor& executor,
                           WorldStatistics& statistics);
    void update_shape(const MovingScene& scene,
                      std::uint32_t mesh,
                      Executor& executor,
                      WorldStatistics& statistics);

    bvh::Builder builder_;
    std::uint64_t layout_ = 0;  // of the scene
    std::vector<KeptMesh> kept_;
    std::vector<std::uint32_t> present_;  // meshes with triangles: the primitives of the upper tree
    bvh::DeformableBvh upper_;
    std::uint64_t version_ = 0;
    bool is_upper_current_ = false;
    BvttFront front_;
};

}  // namespace earshot::collision
