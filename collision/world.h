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
    /// Which pairs of meshes (a <= b) are looked at; empty: all. Must not change during a call.
    std::function<bool(std::uint32_t a, std::uint32_t b)> filter{};
    /// Elements as near as this along every axis are in contact, metres; 0: exact contact.
    double min_separation = 0.0;
    double tolerance = 1e-6;  ///< metres, with min_separation

    // What saves work; contacts are the same without.

    /// A search begins where the one before ended.
    bool track_front = true;
    /// Patches that face one way and whose border does not meet itself are not searched within;
    /// only without a separation.
    bool cull_with_normal_cones = true;
    /// Every vertex and edge is tested as part of one triangle only.
    bool assign_representatives = true;

    /// Whether anything of two meshes is looked at.
    bool accepts(std::uint32_t a, std::uint32_t b) const {
        return (a == b ? within_meshes : between_meshes) &&
               (!filter || filter(std::min(a, b), std::max(a, b)));
    }

    /// What boxes grow by so that no contact is left out, metres.
    double margin() const noexcept {
        return min_separation > 0.0 ? min_separation + 2.0 * tolerance : 0.0;
    }
};

/// What the last search did.
struct WorldStatistics {
    std::uint64_t box_tests = 0;       ///< of pairs of nodes and of triangles, and patches
    std::uint64_t triangle_pairs = 0;  ///< whose swept boxes meet
    std::uint64_t elementary_tests = 0;

    WorldStatistics& operator+=(const WorldStatistics& other) noexcept;
};

/// Meshes that move, rest or deform, and when what of them touches. A step moves every vertex on a
/// straight line. Every vertex, edge and face of a mesh belongs to its first triangle (Curtis et
/// al. 2008), so each pair of elements is tested once; elements of one mesh that share a vertex are
/// not tested against each other. Contacts depend on the positions alone: trees only leave out what
/// is far away, and each contact is decided by vertex_face_ccd() or edge_edge_ccd().
class World {
public:
    /// The builder of the trees changes what a search costs, not what it finds.
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

    /// All contacts of the step, sorted, each once; the same for any executor. Refits the trees of
    /// the step before, or rebuilds them where they have aged.
    std::vector<Contact> contacts(const ContactOptions& options = {},
                                  Executor& executor = Executor::serial());

    /// All pairs of triangles that meet at the beginning of the step, as find_contacts() and
    /// find_self_contacts() say of the meshes there; sorted, each once, times 0. No separation is
    /// looked at.
    std::vector<Contact> contacts_at_begin(const ContactOptions& options = {},
                                           Executor& executor = Executor::serial());

    /// distance() of two meshes at the beginning of the step; b may be a, which is 0. Triangles are
    /// counted in their mesh. Hierarchies are kept, and refitted after update().
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
