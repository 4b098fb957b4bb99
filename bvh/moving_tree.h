// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/wide_tree.h"

#include <cstdint>
#include <string_view>

namespace earshot::bvh {

/// What an update did to the tree after its vertices had moved, cheapest first.
enum class UpdateAction {
    refit,    ///< boxes follow the triangles; the topology stays
    repair,   ///< then subtrees whose boxes have drifted apart are inserted elsewhere
    rebuild,  ///< all anew
};

/// "refit", "repair" or "rebuild".
std::string_view name_of(UpdateAction action) noexcept;

struct UpdateOptions {
    BuildOptions build{};
    /// Rays that will be asked between two updates: what a slow tree costs is weighed against what
    /// mending it costs. 0: never anything but refits.
    double rays_per_update = 1e6;
};

struct UpdateReport {
    UpdateAction action = UpdateAction::refit;
    double refitted_steps = 0.0;  ///< expected_steps() after the refit
    double steps = 0.0;           ///< and after what was done about it
};

/// The hierarchy of a mesh that deforms: keeps itself fast to ask at the least expected cost. The
/// rays' answers do not depend on what it decides, and what it decides depends on the meshes and
/// options alone, not on a clock or the executor.
class MovingTree {
public:
    /// Builds. Throws as Tree::build() and WideTree::build() do.
    MovingTree(const geometry::MeshView& mesh,
               const UpdateOptions& options = {},
               Executor& executor = Executor::serial());

    /// Follows the mesh. A repair or rebuild is due as soon as the steps that rays have made in
    /// excess of a fresh tree's, since the last one, have cost as much as it does: so that what is
    /// spent is at most twice what the best choice of instants would have spent. What has not
    /// helped before is waited for longer. Precondition: the triangles of the mesh given first.
    UpdateReport update(const geometry::MeshView& mesh, Executor& executor = Executor::serial());

    /// To be asked with the mesh given last.
    const WideTree& tree() const noexcept { return wide_; }

    /// Grows by one whenever the topology changes.
    std::uint64_t version() const noexcept { return version_; }

private:
    /// Something that may be done, its price and its success so far.
    struct Remedy {
        double price = 0.0;     // in steps of rays
        double fresh = 0.0;     // expected steps of a ray when it was last done
        double owed = 0.0;      // steps in excess of that since
        double patience = 1.0;  // times the price
    };

    void build(const geometry::MeshView& mesh, Executor& executor);
    void repair(const geometry::MeshView& mesh, Executor& executor);
    static bool is_due(const Remedy& remedy) noexcept;
    static void settle(Remedy& remedy, const UpdateReport& report) noexcept;

    UpdateOptions options_;
    Tree tree_;  // refitted only when it is repaired
    WideTree wide_;
    Remedy repair_, rebuild_;
    std::uint64_t version_ = 0;
};

}  // namespace earshot::bvh
