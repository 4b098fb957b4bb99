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

/// Chooses at most `budget` items, the important ones with greater probability, such that a small
/// change of the importances changes few choices (temporally coherent importance sampling: Barak et
/// al. 2013). The sum of weight times value over the samples is an unbiased estimate of the sum of
/// any value over all items, if it is 0 where the importance is. The same arguments give the same
/// samples; these are in ascending order of their indices.
///
/// Items whose importance reaches the share of one choice, S / B with S the sum and B the budget
/// that other such items leave, are chosen with certainty and weight 1. Each of the others belongs
/// to one of the remaining slots, by a hash of its identity, and is chosen with the probability
/// f / s: its importance over the sum s of its slot's. So the weighted importances of the samples
/// sum up to exactly S, to rounding.
///
/// The random number of an item follows from its identity and the seed, and never changes (Brewer
/// et al. 1972): in its slot the item of the smallest exponential key -log(u) / f wins (Efraimidis
/// and Spirakis 2006). Multiplying all importances by a number changes nothing. A change of one
/// item's importance changes at most one choice, unless an item becomes certain or ceases to be:
/// that takes or gives back a slot, and with it about two choices.
///
/// Preconditions: as many identities as importances, and different ones; importances are finite and
/// not negative. Costs a time in proportion to the number of items.
std::vector<WeightedSample> coherent_samples(std::span<const double> importances,
                                             std::span<const std::uint64_t> identities,
                                             std::size_t budget,
                                             std::uint64_t seed);

}  // namespace earshot::propagation
