// SPDX-License-Identifier: MIT
#include "earshot/propagation/coherent_sampling.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <bit>

namespace earshot::propagation {
namespace {

constexpr std::uint64_t kSlotStream = 0;
constexpr std::uint64_t kExponentialStream = 1;

/// Joins slots until there are as many as that. With one slot less, only the items of the last one
/// move.
std::size_t joined_slot(std::size_t slot, std::size_t slots) noexcept {
    while (slot >= slots) {
        slot -= std::bit_floor(slot);
    }
    return slot;
}

/// Which items are chosen with certainty. An item that is makes the share of one choice smaller, so
/// that others follow.
std::vector<std::uint8_t> certain_items(std::span<const double> importances, std::size_t budget) {
    std::vector<std::uint8_t> certain(importances.size(), 0);
    const auto wanted = static_cast<std::size_t>(std::count_if(
        importances.begin(), importances.end(), [](double value) { return value > 0.0; }));
    if (wanted <= budget) {
        std::transform(importances.begin(), importances.end(), certain.begin(), [](double value) {
            return static_cast<std::uint8_t>(value > 0.0 ? 1 : 0);
        });
        return certain;
    }
    std::size_t left = budget;
    for (bool changed = true; changed && left > 1;) {
        changed = false;
        double sum = 0.0;
        for (std::size_t i = 0; i < importances.size(); ++i) {
            sum += certain[i] == 0 ? importances[i] : 0.0;
        }
        const double share = sum / static_cast<double>(left);
        // The last choice needs no certainty: whoever has it has its slot to itself.
        for (std::size_t i = 0; i < importances.size() && left > 1; ++i) {
            if (certain[i] == 0 && importances[i] > 0.0 && importances[i] >= share) {
                certain[i] = 1;
                --left;
                changed = true;
            }
        }
    }
    return certain;
}

/// The items of a slot, and the one that is chosen.
struct Slot {
    double sum = 0.0;
    std::size_t index = 0;
};

}  // namespace

SamplingKey sampling_key(std::uint64_t identity, std::uint64_t seed) noexcept {
    return {random(seed, kSlotStream, identity),
            -math::log(1.0 - random(seed, kExponentialStream, identity))};
}

std::vector<WeightedSample> coherent_samples(std::span<const double> importances,
                                             std::span<const SamplingKey> keys,
                                             std::size_t budget) {
    EARSHOT_ASSERT(keys.size() == importances.size());
    std::vector<WeightedSample> samples;
    if (budget == 0) {
        return samples;
    }
    const std::vector<std::uint8_t> certain = certain_items(importances, budget);
    for (std::size_t i = 0; i < certain.size(); ++i) {
        if (certain[i] != 0) {
            samples.push_back({i, 1.0});
        }
    }
    std::vector<Slot> slots(std::min(budget, importances.size()) - samples.size());
    for (std::size_t i = 0; i < importances.size(); ++i) {
        if (certain[i] != 0 || !(importances[i] > 0.0)) {
            continue;
        }
        const auto first = static_cast<std::size_t>(keys[i].slot * static_cast<double>(budget));
        Slot& slot = slots[joined_slot(first, slots.size())];
        // Products in place of quotients, which take longer.
        if (slot.sum == 0.0 || keys[i].exponential * importances[slot.index] <
                                   keys[slot.index].exponential * importances[i]) {
            slot.index = i;
        }
        slot.sum += importances[i];
    }
    for (const Slot& slot : slots) {
        if (slot.sum > 0.0) {
            samples.push_back({slot.index, slot.sum / importances[slot.index]});
        }
    }
    std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) {
        return a.index < b.index;
    });
    return samples;
}

}  // namespace earshot::propagation
