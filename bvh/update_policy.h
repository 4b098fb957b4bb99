// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <string_view>

namespace earshot::bvh {

/// What an update did to a tree after its primitives had moved, cheapest first.
enum class UpdateAction {
    refit,    ///< boxes follow the primitives; the topology stays
    repair,   ///< then subtrees whose boxes have drifted apart are reinserted
    rebuild,  ///< a new tree
};

/// "refit", "repair" or "rebuild".
std::string_view name_of(UpdateAction action) noexcept;

struct UpdateReport {
    UpdateAction action = UpdateAction::refit;
    double sah_cost_after_refit = 0.0;  ///< sah_cost() of the tree when it was refitted
    double sah_cost = 0.0;              ///< and at the end of the update
};

/// Chooses between refit, repair and rebuild, so that updates and queries together cost the least.
/// All costs are in node visits of queries: what is decided depends on the trees and the number of
/// queries alone, not on a clock, the machine or the executor.
///
/// A repair or rebuild is due as soon as the excess cost of queries, over what they cost in the
/// tree when the action was last taken, has added up to the cost of the action (ski rental): so
/// that updates and excess together are at most twice those of the best choice of instants. An
/// action that has gained too little backs off: its threshold doubles.
class UpdatePolicy {
public:
    /// What the actions cost, in node visits.
    struct ActionCosts {
        double repair = 0.0, rebuild = 0.0;
    };

    UpdatePolicy() = default;
    /// For a new tree of that SAH cost.
    UpdatePolicy(const ActionCosts& costs, double sah_cost);

    /// The action that is due in a tree that was refitted, given the number of queries until the
    /// next update.
    UpdateAction choose(double sah_cost_after_refit, double queries) noexcept;

    /// To be called after a repair or a rebuild.
    void record_outcome(const UpdateReport& report) noexcept;

private:
    /// Amortised accounting of one kind of action.
    struct ActionAccount {
        double action_cost = 0.0;
        double baseline_sah_cost = 0.0;   // of the tree when the action was last taken
        double accumulated_excess = 0.0;  // of queries since, over the baseline
        double backoff = 1.0;             // factor of the action's cost at which it is due

        bool is_due() const noexcept;
        void accumulate(double sah_cost, double queries) noexcept;
        void record_outcome(const UpdateReport& report) noexcept;
        void reset(double sah_cost) noexcept;
    };

    ActionAccount repair_, rebuild_;
};

}  // namespace earshot::bvh
