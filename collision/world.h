// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/collision/contact.h"
#include "earshot/collision/discrete.h"
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

    /// The mesh moves from `begin` to `end` in the next step; equal for one that rests. Throws
    /// Error if a position is not finite. Precondition: as many positions as vertices.
    void update(std::uint32_t mesh,
                std::span<const geometry::Vec3> begin,
                std::span<const geometry::Vec3> end);

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

    /// The first of contacts(), if there is one.
    std::optional<Contact> first_contact(const ContactOptions& options = {},
                                         Executor& executor = Executor::serial());

    const WorldStatistics& statistics() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::collision
