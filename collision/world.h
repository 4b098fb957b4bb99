// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/collision/contact.h"
#include "earshot/collision/contact_options.h"
#include "earshot/collision/convex.h"
#include "earshot/collision/discrete.h"
#include "earshot/collision/rigid_motion.h"
#include "earshot/collision/statistics.h"
#include "earshot/geometry/animated_mesh.h"
#include "earshot/geometry/mesh.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace earshot::collision {

/// The paths of vertices between two instants.
enum class Path { chords, screws };

/// Meshes that move, rest or deform, and their contacts. A step moves every vertex on a straight
/// line. Every vertex and edge of a mesh has one representative triangle (Curtis et al. 2008), so
/// each pair of elements is tested once; elements of one mesh that share a vertex are not tested
/// against each other. Contacts depend on the positions alone: the broad phase culls
/// conservatively, and each contact is decided by vertex_face_ccd() or edge_edge_ccd().
class World {
public:
    /// The builder of the BVHs changes the cost of a search, not its result.
    explicit World(bvh::Builder builder = bvh::Builder::binned_sah);
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    /// A mesh of `vertices` vertices, all at the origin until update(). Returns its number. Throws
    /// Error if a triangle names a vertex that is not there.
    std::uint32_t add_mesh(std::span<const geometry::Triangle> triangles, std::size_t vertices);

    /// Adds all meshes of a scene, in its order; set_step() moves them. Returns the number of the
    /// first. With `weld`, vertices of one mesh that are at one position at every instant are one
    /// vertex, the one of the lowest index (see weld.h); never across meshes.
    std::uint32_t add(geometry::AnimatedMesh scene, bool weld = true);

    /// Takes a mesh out of the world: no contact is with it any more. Other meshes keep their
    /// numbers. Precondition: it was added, and not removed before.
    void remove_mesh(std::uint32_t mesh);

    /// In the next step all meshes of scenes move from where they are at `t0` to where they are at
    /// `t1`, seconds. On screws, meshes whose vertices follow one node that is not scaled rotate
    /// with it, instead of every vertex on a chord; a step in which that is not one screw is split
    /// (up to 64 times). Throws as update().
    void set_step(double t0, double t1, Path path = Path::chords);

    /// Whether any vertex of a mesh moves in the step.
    bool moves(std::uint32_t mesh) const noexcept;

    /// How far a mesh of a scene that follows a node turns between two instants, radians; 0 for
    /// others.
    double turn(std::uint32_t mesh, double t0, double t1) const;

    /// The mesh moves from `begin` to `end` in the next step; equal for one that rests. Coordinates
    /// below geometry::kMinCoordinate count as 0. Throws Error if a position is not finite.
    /// Preconditions: as many positions as vertices; the mesh was not removed.
    void update(std::uint32_t mesh,
                std::span<const geometry::Vec3> begin,
                std::span<const geometry::Vec3> end);

    /// The mesh moves from `begin` on a screw in the next step. Contacts of meshes on different
    /// screws, or of one on a screw and one that is not, are never missed and never late, and may
    /// be 1e-9 of the extent of the features' motion apart; within a mesh, and between meshes on
    /// equal screws, they are those of meshes at rest.
    void update(std::uint32_t mesh, std::span<const geometry::Vec3> begin, const Screw& screw);

    /// All contacts of the step, sorted, each once; the same for any executor. The BVH of the last
    /// step is refitted, repaired or rebuilt, as bvh::DeformableBvh decides from the work of the
    /// last search.
    std::vector<Contact> contacts(const ContactOptions& options = {},
                                  Executor& executor = Executor::serial());

    /// All pairs of triangles that intersect at the beginning of the step, as find_contacts() and
    /// find_self_contacts() find them; sorted, each once, with time 0. The minimum separation is
    /// not used. BVHs of meshes are kept, and updated where update() has moved them.
    std::vector<Contact> contacts_at_begin(const ContactOptions& options = {},
                                           Executor& executor = Executor::serial());

    /// distance() of two meshes at the beginning of the step; b may be a, which is 0. Triangles are
    /// numbered within their mesh.
    MeshDistance distance_at_begin(std::uint32_t a,
                                   std::uint32_t b,
                                   Executor& executor = Executor::serial());

    /// penetration_depth() of the convex solids of two meshes at the beginning of the step; b may
    /// be a: of its own parts. Nothing if none overlap, or a mesh does not consist of convex
    /// solids.
    std::optional<SolidDepth> depth_at_begin(std::uint32_t a, std::uint32_t b);

    /// The first of contacts(), if there is one. Elements that come close later than a contact
    /// that was found are not tested, nor are parts of a step on screws after it.
    std::optional<Contact> first_contact(const ContactOptions& options = {},
                                         Executor& executor = Executor::serial());

    /// Meshes that were removed count.
    std::uint32_t mesh_count() const noexcept;
    /// Of the last contacts(), contacts_at_begin(), distance_at_begin() or first_contact().
    const WorldStatistics& statistics() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::collision
