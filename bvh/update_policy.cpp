// SPDX-License-Identifier: MIT
#include "earshot/bvh/update_policy.h"

#include <algorithm>

namespace earshot::bvh {
namespace {

// An action that lowers the SAH cost by less has not paid, and backs off.
constexpr double kMinGain = 0.03;
constexpr double kMaxBackoff = 64.0;

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

bool UpdatePolicy::ActionAccount::is_due() const noexcept {
    return accumulated_excess > 0.0 && accumulated_excess >= backoff * action_cost;
}

void UpdatePolicy::ActionAccount::accumulate(double sah_cost, double queries) noexcept {
    accumulated_excess += std::max(0.0, sah_cost - baseline_sah_cost) * queries;
}

void UpdatePolicy::ActionAccount::record_outcome(const UpdateReport& report) noexcept {
    const bool has_paid = report.sah_cost < (1.0 - kMinGain) * report.sah_cost_after_refit;
    backoff = has_paid ? 1.0 : std::min(2.0 * backoff, kMaxBackoff);
    reset(report.sah_cost);
}

void UpdatePolicy::ActionAccount::reset(double sah_cost) noexcept {
    accumulated_excess = 0.0;
    baseline_sah_cost = sah_cost;
}

UpdatePolicy::UpdatePolicy(const ActionCosts& costs, double sah_cost)
    : repair_{.action_cost = costs.repair, .baseline_sah_cost = sah_cost},
      rebuild_{.action_cost = costs.rebuild, .baseline_sah_cost = sah_cost} {}

UpdateAction UpdatePolicy::choose(double sah_cost_after_refit, double queries) noexcept {
    for (ActionAccount* account : {&repair_, &rebuild_}) {
        account->accumulate(sah_cost_after_refit, queries);
    }
    return rebuild_.is_due()  ? UpdateAction::rebuild
           : repair_.is_due() ? UpdateAction::repair
                              : UpdateAction::refit;
}

void UpdatePolicy::record_outcome(const UpdateReport& report) noexcept {
    if (report.action == UpdateAction::rebuild) {
        rebuild_.record_outcome(report);
        // A new tree needs no repair.
        repair_.reset(report.sah_cost);
    } else if (report.action == UpdateAction::repair) {
        repair_.record_outcome(report);
    }
}

}  // namespace earshot::bvh
