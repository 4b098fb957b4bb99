// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/wide_tree.h"

#include <cstdint>
#include <string_view>

namespace earshot::bvh {

/// What an update did to the tree after its vertices had moved, cheapest first.
enum class UpdateAction {
    refit,    ///< boxes follow the triangles; the topology stays
    repair,   ///< then subtrees whose boxes have drifted apart are reinserted
    rebuild,  ///< a new tree
};

/// "refit", "repair" or "rebuild".
std::string_view name_of(UpdateAction action) noexcept;

struct UpdateOptions {
    BuildOptions build{};
    /// Rays that will be traced between two updates: what they cost in excess in a degraded tree is
    /// weighed against what a repair or rebuild costs. 0: refits only.
    double rays_per_update = 1e6;
};

struct UpdateReport {
    UpdateAction action = UpdateAction::refit;
    double sah_cost_after_refit = 0.0;  ///< sah_cost() of the wide tree when it was refitted
    double sah_cost = 0.0;              ///< and at the end of the update
};

/// The hierarchy of a mesh that deforms: it chooses between refit, repair and rebuild so that
/// updates and rays together cost the least. The rays' answers do not depend on what it decides,
/// and what it decides depends on the meshes and options alone, not on a clock or the executor.
class DeformableBvh {
public:
    /// Builds the tree. Throws as Tree::build() and WideTree::build() do.
    DeformableBvh(const geometry::MeshView& mesh,
                  const UpdateOptions& options = {},
                  Executor& executor = Executor::serial());

    /// Follows the mesh. A repair or rebuild is due as soon as the excess cost of rays, over what
    /// they cost in the tree when the action was last taken, has added up to the cost of the action
    /// (ski rental): so that updates and excess together are at most twice those of the best choice
    /// of instants. An action that has gained too little backs off: its threshold doubles.
    /// Precondition: the mesh has the triangles of the mesh that the tree was built over.
    UpdateReport update(const geometry::MeshView& mesh, Executor& executor = Executor::serial());

    /// To be queried with the mesh given last.
    const WideTree& tree() const noexcept { return wide_; }

    /// Grows by one whenever the topology changes.
    std::uint64_t version() const noexcept { return version_; }

private:
    /// Amortised accounting of one kind of action. Costs are in node visits of rays.
    struct ActionAccount {
        double action_cost = 0.0;
        double baseline_sah_cost = 0.0;   // of the tree when the action was last taken
        double accumulated_excess = 0.0;  // of rays since, over the baseline
        double backoff = 1.0;             // factor of the action's cost at which it is due

        bool is_due() const noexcept;
        void accumulate(double sah_cost, double rays) noexcept;
        void record_outcome(const UpdateReport& report) noexcept;
        void reset(double sah_cost) noexcept;
    };

    void build(const geometry::MeshView& mesh, Executor& executor);
    void repair(const geometry::MeshView& mesh, Executor& executor);

    UpdateOptions options_;
    Tree tree_;  // refitted only when it is repaired
    WideTree wide_;
    ActionAccount repair_, rebuild_;
    std::uint64_t version_ = 0;
};

}  // namespace earshot::bvh
