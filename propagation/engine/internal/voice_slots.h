// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace earshot::propagation {

/// Which voices of a listener are in use, as the update thread knows it. A voice whose path has
/// ended is free when the sound has come to a snapshot without it and has gone on from there.
class VoiceSlots {
public:
    static constexpr std::uint32_t kNone = 0xffffffff;

    explicit VoiceSlots(std::size_t count) {
        for (std::size_t slot = count; slot-- > 0;) {
            free_.push_back(static_cast<std::uint32_t>(slot));
        }
    }

    /// kNone if all are in use.
    std::uint32_t allocate() {
        if (free_.empty()) {
            return kNone;
        }
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        return slot;
    }
    /// Its path is not in the snapshot of that number, nor later.
    void release(std::uint32_t slot, std::uint64_t number) { ending_.push_back({slot, number}); }
    /// The sound has gone on from the snapshot of that number.
    void reclaim(std::uint64_t number) {
        while (!ending_.empty() && ending_.front().number <= number) {
            free_.push_back(ending_.front().slot);
            ending_.pop_front();
        }
    }

private:
    struct Ending {
        std::uint32_t slot = 0;
        std::uint64_t number = 0;
    };
    std::vector<std::uint32_t> free_;
    std::deque<Ending> ending_;  // numbers ascend
};

}  // namespace earshot::propagation
