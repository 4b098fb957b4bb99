// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace earshot::propagation {

/// A value that one thread writes and another reads, where the newest counts and neither ever
/// waits: three copies, one for each of them and one between, which they exchange for theirs.
template <typename Value>
class TripleBuffer {
public:
    explicit TripleBuffer(const Value& initial) { values_.fill(initial); }

    /// The writer's copy, of any age.
    Value& back() noexcept { return values_[back_]; }
    /// Makes the writer's copy the newest.
    void publish() noexcept {
        back_ = middle_.exchange(back_ | kIsNew, std::memory_order_acq_rel) & kIndex;
    }

    /// Whether the reader's copy has been replaced by a newer one.
    bool take_newest() noexcept {
        if ((middle_.load(std::memory_order_relaxed) & kIsNew) == 0) {
            return false;
        }
        front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
        return true;
    }
    /// The reader's copy.
    const Value& front() const noexcept { return values_[front_]; }

private:
    static constexpr std::uint8_t kIndex = 3;
    static constexpr std::uint8_t kIsNew = 4;
    static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

    std::array<Value, 3> values_;
    std::uint8_t back_ = 0;
    std::uint8_t front_ = 1;
    std::atomic<std::uint8_t> middle_{2};
};

}  // namespace earshot::propagation
