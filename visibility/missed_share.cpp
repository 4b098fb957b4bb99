// SPDX-License-Identifier: MIT
#include "earshot/visibility/missed_share.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"

namespace earshot::visibility {

namespace {

/// Terms of the sum that are smaller than this fraction of the first change no digit that is shown.
constexpr double kNegligible = 1e-17;

/// log(n over k)
double log_binomial(std::uint64_t n, std::uint64_t k) noexcept {
    double sum = 0.0;
    for (std::uint64_t i = 1; i <= k; ++i) {
        sum += math::log(static_cast<double>(n - k + i) / static_cast<double>(i));
    }
    return sum;
}

/// The probability of at most k successes in n trials. `log_ways`: log_binomial(n, k).
double cumulative(std::uint64_t k, std::uint64_t n, double p, double log_ways) noexcept {
    // The largest term in the tail of interest, p >= k / n, is the last; the others follow by their
    // ratio.
    const double failures = static_cast<double>(n - k);
    const double last =
        log_ways + static_cast<double>(k) * math::log(p) + failures * math::log(1.0 - p);
    double term = 1.0;
    double sum = 1.0;
    for (std::uint64_t i = k; i > 0 && term > kNegligible * sum; --i) {
        term *= static_cast<double>(i) * (1.0 - p) / (static_cast<double>(n - i + 1) * p);
        sum += term;
    }
    return math::exp(last) * sum;
}

}  // namespace

// Clopper and Pearson 1934. The probability of at most so many successes falls with p, from 1 at 0
// to 0 at 1, so that bisection finds where it is 1 - confidence.
double clopper_pearson_upper(std::uint64_t successes,
                             std::uint64_t trials,
                             double confidence) noexcept {
    EARSHOT_ASSERT(successes <= trials && confidence > 0.0 && confidence < 1.0);
    if (successes == trials) {
        return 1.0;
    }
    const double log_ways = log_binomial(trials, successes);
    double below = static_cast<double>(successes) / static_cast<double>(trials);
    double above = 1.0;
    // Until no double lies in between.
    for (double middle = 0.5 * (below + above); below < middle && middle < above;
         middle = 0.5 * (below + above)) {
        const bool is_likely = cumulative(successes, trials, middle, log_ways) > 1.0 - confidence;
        (is_likely ? below : above) = middle;
    }
    return above;
}

double MissedShare::estimate() const noexcept {
    EARSHOT_ASSERT(rays > 0);
    return static_cast<double>(missed) / static_cast<double>(rays);
}

double MissedShare::upper_bound() const noexcept {
    return clopper_pearson_upper(missed, rays, kConfidence);
}

}  // namespace earshot::visibility
