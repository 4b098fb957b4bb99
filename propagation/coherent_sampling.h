// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// An item that is chosen from many, to stand for others as well.
struct WeightedSample {
    std::size_t index = 0;
    double weight = 0.0;  ///< the inverse of the probability with which it was chosen
};

/// The random numbers of an item, which it keeps as long as it exists (permanent random numbers:
/// Brewer et al. 1972).
struct SamplingKey {
    double slot = 0.0;         ///< uniform in [0, 1)
    double exponential = 0.0;  ///< of mean 1, independent of the other
};

/// A pure function of what tells the item from others, and of the seed.
SamplingKey sampling_key(std::uint64_t identity, std::uint64_t seed) noexcept;

/// Chooses at most `budget` items, the important ones with greater probability, such that a small
/// change of the importances changes few choices (temporally coherent importance sampling: Barak et
/// al. 2013). The sum of weight times value over the samples is an unbiased estimate of the sum of
/// any value over all items, if it is 0 where the importance is. The same arguments give the same
/// samples; these are in ascending order of their indices.
///
/// Items whose importance reaches the share of one choice, S / B with S the sum and B the budget
/// that other such items leave, are chosen with certainty and weight 1. Each of the others belongs
/// to a slot, and is chosen with the probability f / s: its importance over the sum s of its
/// slot's. So the weighted importances of the samples sum up to exactly S, to rounding.
///
/// The slot is floor(SamplingKey::slot * budget). As certain items leave only B slots, a slot of
/// number k >= B is joined with that of k without its highest bit, until that is below B (linear
/// hashing: Litwin 1980). In a slot the item wins whose exponential number over its importance is
/// the smallest (Efraimidis and Spirakis 2006).
///
/// Multiplying all importances by a number changes nothing. A change of one item's importance
/// changes at most one choice, unless items become certain or cease to be: each takes or gives back
/// a slot, and with it about two choices.
///
/// Preconditions: as many keys as importances; importances are finite and not negative. Costs a
/// time in proportion to the number of items.
std::vector<WeightedSample> coherent_samples(std::span<const double> importances,
                                             std::span<const SamplingKey> keys,
                                             std::size_t budget);

}  // namespace earshot::propagation
