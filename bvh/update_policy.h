// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <string_view>

namespace earshot::bvh {

/// What an update did to a tree after its primitives had moved, cheapest first.
enum class UpdateAction {
    refit,    ///< boxes follow the primitives; the topology stays
    repair,   ///< then subtrees whose boxes have drifted apart are reinserted, or a kept topology
              ///< takes over again (see UpdateReport::is_restored)
    rebuild,  ///< a new tree
};

/// "refit", "repair" or "rebuild".
std::string_view name_of(UpdateAction action) noexcept;

struct UpdateReport {
    UpdateAction action = UpdateAction::refit;
    double sah_cost_after_refit = 0.0;  ///< sah_cost() of the tree when it was refitted
    double sah_cost = 0.0;              ///< and at the end of the update
    bool is_restored = false;           ///< the topology that was kept took over again
};

/// Chooses between refit, repair and rebuild, so that updates and queries together cost the least.
/// All costs are in node visits of queries: what is decided depends on the trees and the number of
/// queries alone, not on a clock, the machine or the executor.
///
/// An action is due as soon as the excess cost of queries, over what they would cost in a new tree,
/// has added up to the cost of the action (ski rental): so that updates and excess together are at
/// most twice those of the best choice of instants. An action that has gained too little backs off:
/// its threshold doubles.
///
/// A repair is cheaper than a rebuild, but may leave a part of the excess. It is given up for a
/// rebuild if that part makes it the dearer one, and tried again only after four rebuilds, twice as
/// many each time. What a new tree would cost is known by rebuilds alone: there is one after at
/// most so many repairs, twice as many each time unless it finds a much better tree than they did.
///
/// When the topology has changed, another one is kept: poses may come back for which that one is
/// better. What it would cost is looked up as often as a small share of the queries' cost pays for,
/// more seldom if it was much worse, and before an action that costs much more. It takes over again
/// when what it would have saved has added up to the cost of that, or when it is as good as what a
/// repair or rebuild that is due may be expected to lead to.
class UpdatePolicy {
public:
    /// What the actions cost, in node visits.
    struct ActionCosts {
        double repair = 0.0, rebuild = 0.0;
        double restore = 0.0;  ///< of the kept topology
        double look_up = 0.0;  ///< of what the kept topology would cost
    };

    UpdatePolicy() = default;
    /// For a new tree of that SAH cost.
    UpdatePolicy(const ActionCosts& costs, double sah_cost);

    /// The action that is due in a tree that was refitted, given the number of queries until the
    /// next update.
    UpdateAction choose(double sah_cost_after_refit, double queries) noexcept;

    /// Whether a repair that is due is worth completing, given the SAH cost that it leads to; if
    /// not, a rebuild is due.
    bool is_repair_worthwhile(double sah_cost_after_refit, double sah_cost) noexcept;

    /// Whether to look up what the kept topology would cost, given the action that is due.
    bool is_look_up_due(UpdateAction due) const noexcept;

    /// Whether the kept topology should take over, in place of the action that is due, if any. To
    /// be called once after a look-up, with the SAH costs of both topologies.
    bool should_restore(UpdateAction due, double sah_cost, double kept_sah_cost) noexcept;

    /// To be called after a repair or a rebuild.
    void record_outcome(const UpdateReport& report) noexcept;

private:
    /// Accounting of the kept topology.
    struct KeptAccount {
        double queries = 0.0;             // since the last look-up
        double query_cost = 0.0;          // of these
        double accumulated_excess = 0.0;  // over what queries would have cost in the kept topology
        double backoff = 1.0;             // factor of the look-up's cost
    };

    static constexpr int kMinRepairBackoff = 4;

    double action_cost(UpdateAction action) const noexcept;

    ActionCosts costs_;
    double baseline_sah_cost_ = 0.0;   // of the best tree of late
    double accumulated_excess_ = 0.0;  // of queries over it, since the last action
    double backoff_ = 1.0;             // factor of an action's cost at which it is due
    int repairs_left_ = 1;             // until the next rebuild
    int max_repairs_ = 1;              // between two rebuilds
    int rebuilds_left_ = 0;            // until a repair is tried again
    int repair_backoff_ = kMinRepairBackoff;
    KeptAccount kept_;
};

}  // namespace earshot::bvh
