// SPDX-License-Identifier: MIT
#include "earshot/propagation/coherent_sampling.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/base/random.h"

#include <algorithm>
#include <limits>

namespace earshot::propagation {
namespace {

constexpr std::uint64_t kSlotStream = 0;
constexpr std::uint64_t kKeyStream = 1;

/// The slot of an item, evenly spread: with one slot more, only the items that belong to that one
/// move (jump consistent hash: Lamping and Veach 2014).
std::size_t slot_of(std::uint64_t bits, std::size_t slots) noexcept {
    constexpr std::uint64_t kMultiplier = 2862933555777941757ULL;
    std::uint64_t slot = 0;
    std::uint64_t next = 0;
    while (next < slots) {
        slot = next;
        bits = bits * kMultiplier + 1;
        next = static_cast<std::uint64_t>(static_cast<double>(slot + 1) *
                                          (0x1p31 / static_cast<double>((bits >> 33) + 1)));
    }
    return static_cast<std::size_t>(slot);
}

/// Which items are chosen with certainty. An item that is makes the share of one choice smaller, so
/// that others follow.
std::vector<std::uint8_t> certain_items(std::span<const double> importances, std::size_t budget) {
    std::vector<std::uint8_t> certain(importances.size(), 0);
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
    double key = std::numeric_limits<double>::infinity();
    std::size_t index = 0;
};

}  // namespace

std::vector<WeightedSample> coherent_samples(std::span<const double> importances,
                                             std::span<const std::uint64_t> identities,
                                             std::size_t budget,
                                             std::uint64_t seed) {
    EARSHOT_ASSERT(identities.size() == importances.size());
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
    std::vector<Slot> slots(budget - samples.size());
    const RandomStream slot_bits(seed, kSlotStream);
    const RandomStream numbers(seed, kKeyStream);
    for (std::size_t i = 0; i < importances.size(); ++i) {
        if (certain[i] != 0 || !(importances[i] > 0.0)) {
            continue;
        }
        Slot& slot = slots[slot_of(slot_bits.bits(identities[i]), slots.size())];
        slot.sum += importances[i];
        const double key = -math::log(1.0 - numbers.at(identities[i])) / importances[i];
        if (key < slot.key || (key == slot.key && identities[i] < identities[slot.index])) {
            slot.key = key;
            slot.index = i;
        }
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
