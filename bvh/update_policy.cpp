// SPDX-License-Identifier: MIT
#include "earshot/bvh/update_policy.h"

#include <algorithm>

namespace earshot::bvh {
namespace {

// An action that lowers the SAH cost by less has not paid, and backs off.
constexpr double kMinGain = 0.03;
constexpr double kMaxBackoff = 64.0;

// Repairs have been much worse than a rebuild if that finds a tree which costs less by so much.
constexpr double kMaxRepairDeficit = 0.05;
constexpr int kMaxRepairs = 64;  // between two rebuilds
// An excess of so many rebuilds is more than a repair may leave a part of.
constexpr double kMaxRepairExcess = 2.0;

// What looking up the kept topology may cost, over what queries cost.
constexpr double kLookUpShare = 0.01;
// And over the cost of an action that is due.
constexpr double kLookUpShareOfAction = 0.5;
// A kept topology of twice the cost is looked up so many times less often.
constexpr double kLookUpBackoff = 8.0;

}  // namespace

std::string_view name_of(UpdateAction action) noexcept {
    switch (action) {
        case UpdateAction::refit:
            return "refit";
        case UpdateAction::repair:
            return "repair";
        case UpdateAction::rebuild:
            break;
    }
    return "rebuild";
}

UpdatePolicy::UpdatePolicy(const ActionCosts& costs, double sah_cost)
    : costs_(costs), baseline_sah_cost_(sah_cost) {}

double UpdatePolicy::action_cost(UpdateAction action) const noexcept {
    return action == UpdateAction::rebuild  ? costs_.rebuild
           : action == UpdateAction::repair ? costs_.repair
                                            : 0.0;
}

UpdateAction UpdatePolicy::choose(double sah_cost_after_refit, double queries) noexcept {
    accumulated_excess_ += std::max(0.0, sah_cost_after_refit - baseline_sah_cost_) * queries;
    kept_.queries += queries;
    kept_.query_cost += queries * sah_cost_after_refit;
    const bool may_repair = repairs_left_ > 0 && rebuilds_left_ == 0 &&
                            accumulated_excess_ <= kMaxRepairExcess * backoff_ * costs_.rebuild;
    const UpdateAction next = may_repair ? UpdateAction::repair : UpdateAction::rebuild;
    const bool is_due =
        accumulated_excess_ > 0.0 && accumulated_excess_ >= backoff_ * action_cost(next);
    return is_due ? next : UpdateAction::refit;
}

bool UpdatePolicy::is_repair_worthwhile(double sah_cost_after_refit, double sah_cost) noexcept {
    const double excess = sah_cost_after_refit - baseline_sah_cost_;
    const double rest = excess > 0.0 ? std::max(0.0, sah_cost - baseline_sah_cost_) / excess : 0.0;
    // An excess like this one will add up again; of that, a repair leaves the rest.
    if (costs_.repair + rest * accumulated_excess_ / backoff_ <= costs_.rebuild) {
        repair_backoff_ = kMinRepairBackoff;
        return true;
    }
    rebuilds_left_ = repair_backoff_;
    repair_backoff_ = std::min(2 * repair_backoff_, kMaxRepairs);
    return false;
}

bool UpdatePolicy::is_look_up_due(UpdateAction due) const noexcept {
    const double budget =
        std::max(kLookUpShare * kept_.query_cost, kLookUpShareOfAction * action_cost(due));
    return budget > 0.0 && budget >= kept_.backoff * costs_.look_up;
}

bool UpdatePolicy::should_restore(UpdateAction due,
                                  double sah_cost,
                                  double kept_sah_cost) noexcept {
    // 1. Settle what has passed since the last look-up.
    const double saving = sah_cost - kept_sah_cost;
    kept_.accumulated_excess =
        saving > 0.0 ? kept_.accumulated_excess + saving * kept_.queries : 0.0;
    kept_.backoff = 1.0 + kLookUpBackoff * std::max(0.0, -saving / sah_cost);
    kept_.queries = 0.0;
    kept_.query_cost = 0.0;
    if (!(saving > 0.0)) {
        return false;
    }
    // 2. In place of an action that is due: if no more is to be expected of it.
    if (due != UpdateAction::refit) {
        if (kept_sah_cost > (1.0 + kMinGain) * baseline_sah_cost_) {
            return false;
        }
        accumulated_excess_ = 0.0;
    } else if (kept_.accumulated_excess < costs_.restore) {
        return false;
    }
    kept_.accumulated_excess = 0.0;
    return true;
}

void UpdatePolicy::record_outcome(const UpdateReport& report) noexcept {
    const bool has_paid = report.sah_cost < (1.0 - kMinGain) * report.sah_cost_after_refit;
    backoff_ = has_paid ? 1.0 : std::min(2.0 * backoff_, kMaxBackoff);
    accumulated_excess_ = 0.0;
    if (report.action == UpdateAction::repair) {
        --repairs_left_;
        baseline_sah_cost_ = std::min(baseline_sah_cost_, report.sah_cost);
        return;
    }
    const bool is_much_better = report.sah_cost < (1.0 - kMaxRepairDeficit) * baseline_sah_cost_;
    max_repairs_ = is_much_better ? 1 : std::min(2 * max_repairs_, kMaxRepairs);
    repairs_left_ = max_repairs_;
    rebuilds_left_ = std::max(rebuilds_left_ - 1, 0);
    baseline_sah_cost_ = report.sah_cost;
}

}  // namespace earshot::bvh
