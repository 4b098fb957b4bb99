// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace earshot::geometry {

/// Mixes a number into a hash, whose low bits depend on all of it.
constexpr std::uint64_t mixed_hash(std::uint64_t hash, std::uint64_t value) noexcept {
    constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15U;
    hash = (hash ^ value) * kOdd;
    return hash ^ (hash >> 32U);
}

/// Tells of each of some indexed things the first one that equals it: a hash table with open
/// addressing.
class FirstIndexTable {
public:
    /// For up to `count` things.
    explicit FirstIndexTable(std::size_t count) : slots_(std::bit_ceil(2 * count + 1), kNone) {}

    /// The index of the first thing added that equals this one: `index` itself if there is none.
    /// equals(i) tells whether thing i does; equal things have equal hashes.
    template <typename Equals>
    std::uint32_t add(std::uint64_t hash, std::uint32_t index, const Equals& equals) {
        const std::size_t mask = slots_.size() - 1;
        for (std::size_t slot = hash & mask;; slot = (slot + 1) & mask) {
            if (slots_[slot] == kNone) {
                slots_[slot] = index;
                return index;
            }
            if (equals(slots_[slot])) {
                return slots_[slot];
            }
        }
    }

    /// The index of the first thing added of which equals(i) is true, or kNone.
    template <typename Equals>
    std::uint32_t find(std::uint64_t hash, const Equals& equals) const {
        const std::size_t mask = slots_.size() - 1;
        std::size_t slot = hash & mask;
        while (slots_[slot] != kNone && !equals(slots_[slot])) {
            slot = (slot + 1) & mask;
        }
        return slots_[slot];
    }
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

private:
    std::vector<std::uint32_t> slots_;
};

}  // namespace earshot::geometry
