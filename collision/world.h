// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/collision/contact.h"
#include "earshot/collision/convex.h"
#include "earshot/collision/discrete.h"
#include "earshot/collision/rigid_motion.h"
#include "earshot/geometry/animated_mesh.h"
#include "earshot/geometry/mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace earshot::collision {

struct ContactOptions {
    bool between_meshes = true;
    bool within_meshes = false;  ///< self-collision
    /// Which pairs of meshes (a <= b) are tested; empty: all. Must not change during a call.
    std::function<bool(std::uint32_t a, std::uint32_t b)> filter{};
    /// Elements this close along every axis are in contact, metres; 0: exact contact.
    double min_separation = 0.0;
    double tolerance = 1e-6;  ///< metres, with min_separation

    // Culling methods; contacts are the same without them.

    /// Traversals begin at the front of the bounding-volume test tree where the last one ended.
    bool track_front = true;
    /// Nodes that pass the continuous normal cone and contour tests are not tested against
    /// themselves; only without a minimum separation.
    bool cull_with_normal_cones = true;
    /// Every vertex and edge is tested with its representative triangle only.
    bool assign_representatives = true;

    /// Whether contacts of two meshes are asked for.
    bool accepts(std::uint32_t a, std::uint32_t b) const {
        return (a == b ? within_meshes : between_meshes) &&
               (!filter || filter(std::min(a, b), std::max(a, b)));
    }

    /// How far bounding volumes are padded so that no contact is missed, metres.
    double margin() const noexcept {
        return min_separation > 0.0 ? min_separation + 2.0 * tolerance : 0.0;
    }
};

/// The paths of vertices between two instants.
enum class Path { chords, screws };

/// The work of the last search.
struct WorldStatistics {
    std::uint64_t box_tests = 0;       ///< of pairs of boxes, and of normal cones
    std::uint64_t triangle_pairs = 0;  ///< whose swept boxes overlap
    std::uint64_t elementary_tests = 0;

    WorldStatistics& operator+=(const WorldStatistics& other) noexcept;
};

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
    /// Precondition: as many positions as vertices.
    void update(std::uint32_t mesh,
                std::span<const geometry::Vec3> begin,
                std::span<const geometry::Vec3> end);

    /// The mesh moves from `begin` on a screw in the next step. Contacts of meshes on different
    /// screws, or of one on a screw and one that is not, are never missed and never late, and may
    /// be 1e-9 of the extent of the features' motion apart; within a mesh, and between meshes on
    /// equal screws, they are those of meshes at rest.
    void update(std::uint32_t mesh, std::span<const geometry::Vec3> begin, const Screw& screw);

    /// All contacts of the step, sorted, each once; the same for any executor. Refits the BVH of
    /// the last step, or rebuilds it where its SAH cost has grown.
    std::vector<Contact> contacts(const ContactOptions& options = {},
                                  Executor& executor = Executor::serial());

    /// All pairs of triangles that intersect at the beginning of the step, as find_contacts() and
    /// find_self_contacts() find them; sorted, each once, with time 0. The minimum separation is
    /// not used.
    std::vector<Contact> contacts_at_begin(const ContactOptions& options = {},
                                           Executor& executor = Executor::serial());

    /// distance() of two meshes at the beginning of the step; b may be a, which is 0. Triangles are
    /// numbered within their mesh. BVHs are kept, and refitted after update().
    MeshDistance distance_at_begin(std::uint32_t a,
                                   std::uint32_t b,
                                   Executor& executor = Executor::serial());

    /// penetration_depth() of the convex solids of two meshes at the beginning of the step; b may
    /// be a: of its own parts. Nothing if none overlap, or a mesh does not consist of convex
    /// solids.
    std::optional<SolidDepth> depth_at_begin(std::uint32_t a, std::uint32_t b);

    /// The first of contacts(), if there is one.
    std::optional<Contact> first_contact(const ContactOptions& options = {},
                                         Executor& executor = Executor::serial());

    std::uint32_t mesh_count() const noexcept;
    const WorldStatistics& statistics() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::collision
