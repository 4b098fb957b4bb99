// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/mesh_bvh.h"
#include "earshot/bvh/partial_refit.h"
#include "earshot/bvh/update_policy.h"
#include "earshot/bvh/update_statistics.h"
#include "earshot/bvh/wide_tree.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::bvh {

struct UpdateOptions {
    BuildOptions build{};
    /// Queries between two updates: what they cost in excess in a degraded tree is weighed against
    /// what a repair or rebuild costs. 0: refits only.
    double queries_per_update = 1e6;
    /// What the owner of the tree spends per primitive when the topology changes, in node visits.
    double topology_cost = 0.0;
    /// Where groups of primitives end, such as meshes, each of which gets a subtree of its own (see
    /// build_grouped()); empty: one group. For boxes only.
    std::vector<std::size_t> group_ends{};
};

/// The one keeper of hierarchies that deform: of a mesh, whose rays are traced in its tree(), or of
/// boxes that move, such as swept triangles, facets or instances, in a binary_tree(). An
/// UpdatePolicy chooses between refit, repair and rebuild; what a repair or rebuild does not make
/// cheaper stays as it is. From the first of them on, either the first topology is in use or it is
/// kept, so that motion which comes back to where it began costs no more than refits alone; a
/// kept topology takes as much memory as a Tree. Answers do not depend on what is decided, and what
/// is decided depends on the primitives and options alone.
class DeformableBvh {
public:
    /// Over no boxes.
    DeformableBvh() = default;

    /// Builds the tree of a mesh. Throws as Tree::build() and WideTree::build() do.
    explicit DeformableBvh(const geometry::MeshView& mesh,
                           const UpdateOptions& options = {},
                           Executor& executor = Executor::serial());

    /// Builds the tree of boxes. Throws as Tree::build() does.
    explicit DeformableBvh(std::span<const geometry::Aabb> boxes,
                           const UpdateOptions& options = {},
                           Executor& executor = Executor::serial());

    /// Follows the mesh. Precondition: the hierarchy was built over a mesh of these triangles.
    UpdateReport update(const geometry::MeshView& mesh, Executor& executor = Executor::serial());

    /// The same where only triangles in these ranges, which do not overlap, have moved since the
    /// last update: a refit costs what has moved, and reads a byte per node. See moved_triangles().
    UpdateReport update(const geometry::MeshView& mesh,
                        std::span<const TriangleRange> moved,
                        Executor& executor = Executor::serial());

    /// Follows the boxes. Precondition: the hierarchy was built over as many boxes.
    UpdateReport update(std::span<const geometry::Aabb> boxes,
                        Executor& executor = Executor::serial());

    /// Tells how many queries come per update from now on.
    void expect_queries(double queries) noexcept { options_.queries_per_update = queries; }
    /// The same by the nodes that they visit in the tree as it is, as counted since the last
    /// update.
    void expect_node_visits(double visits) noexcept;

    /// The mesh given last with its tree, which answers queries. Valid until the next update, as
    /// long as the mesh's arrays stay where they are.
    MeshBvh view() const noexcept { return {wide_, mesh_}; }
    /// Of a mesh; to be queried with the mesh given last.
    const WideTree& tree() const noexcept { return wide_; }
    /// Of boxes, as they were given last.
    const Tree& binary_tree() const noexcept { return tree_; }

    /// Of all updates so far.
    const UpdateStatistics& update_statistics() const noexcept { return statistics_; }

    /// Grows by one whenever the topology changes.
    std::uint64_t version() const noexcept { return version_; }

private:
    /// A tree, and of a mesh its wide tree.
    struct Topology {
        Tree tree;
        WideTree wide;
        double sah_cost = 0.0;
    };

    struct Prices;

    void refit_wide(const geometry::MeshView& mesh,
                    std::span<const TriangleRange> moved,
                    Executor& executor);
    void set_policy(const Prices& prices, std::size_t primitives);
    // Below, `mesh` is null for boxes.
    Topology topology_of(Tree tree, const geometry::MeshView* mesh, Executor& executor) const;
    std::optional<Tree> repaired(std::span<const geometry::Aabb> boxes, Executor& executor);
    Tree build(std::span<const geometry::Aabb> boxes, Executor& executor) const;
    double look_up_kept(const geometry::MeshView* mesh,
                        std::span<const geometry::Aabb> boxes,
                        Executor& executor) const;
    void adopt(Topology&& topology);
    void replace(Topology&& topology, const geometry::MeshView* mesh);
    void restore_kept(const geometry::MeshView* mesh,
                      std::span<const geometry::Aabb> boxes,
                      Executor& executor);
    void keep_current(const geometry::MeshView* mesh);
    void change_topology(UpdateReport& report,
                         double kept_cost,
                         const geometry::MeshView* mesh,
                         std::span<const geometry::Aabb> boxes,
                         Executor& executor);
    UpdateReport take_action(const geometry::MeshView* mesh,
                             std::span<const geometry::Aabb> boxes,
                             Executor& executor);

    UpdateOptions options_;
    Tree tree_;  // of a mesh: with the boxes that the wide tree was collapsed for
    WideTree wide_;
    std::optional<PartialRefit> partial_refit_;  // of the wide tree, once it was wanted
    geometry::MeshView mesh_;
    UpdateStatistics statistics_;
    Tree kept_;                              // the other topology, if there is one, likewise
    std::vector<std::uint32_t> kept_slots_;  // of a mesh: nodes in the slots of its wide tree
    bool is_first_topology_ = true;          // that of tree_
    UpdatePolicy policy_;
    double sah_cost_ = 0.0;
    std::uint64_t version_ = 1;
};

}  // namespace earshot::bvh
