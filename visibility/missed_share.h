// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstdint>

namespace earshot::visibility {

/// How much sampled visible sets miss, as estimated by a validation batch of independent rays: the
/// share of all directions from all viewpoints in which the closest hit is missing from the set.
struct MissedShare {
    std::uint64_t rays = 0;    ///< of the batch; 0: nothing is known
    std::uint64_t missed = 0;  ///< rays whose closest hit the set of their cell lacks

    /// The confidence of upper_bound().
    static constexpr double kConfidence = 0.95;

    /// The unbiased estimate, missed / rays. Precondition: rays > 0.
    double estimate() const noexcept;

    /// The upper end of the one-sided Clopper-Pearson interval: sets that miss a larger share show
    /// this few missed rays, or fewer, in less than 5 % of all batches. About 3 / rays if no ray is
    /// missed (the rule of three); 1 if there is no ray.
    double upper_bound() const noexcept;

    friend bool operator==(const MissedShare&, const MissedShare&) = default;
};

/// The upper end of the one-sided Clopper-Pearson interval of a binomial proportion: the p at which
/// so few successes, or fewer, have the probability 1 - confidence. Precondition: successes <=
/// trials; 0 < confidence < 1.
double clopper_pearson_upper(std::uint64_t successes,
                             std::uint64_t trials,
                             double confidence) noexcept;

}  // namespace earshot::visibility
