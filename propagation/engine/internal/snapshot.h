// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/tail_convolver.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace earshot::propagation {

/// A path as it is heard at the time of a snapshot.
struct SnapshotArrival {
    std::uint32_t slot = 0;  ///< of the listener's voices
    std::uint32_t source = 0;
    std::uint64_t id = 0;     ///< of the path: the same as long as it lasts
    double delay = 0.0;       ///< samples
    double delay_rate = 0.0;  ///< samples per sample
};

struct ListenerSnapshot {
    std::vector<SnapshotArrival> arrivals{};
    std::vector<float> weights{};  ///< row per arrival: of the filters, at 1 m
    std::vector<float> gains{};    ///< row per arrival: of the channels
    /// Late sound per source; empty without any.
    std::vector<std::shared_ptr<const audio::Tail>> tails{};
    std::vector<const audio::Tail*> tail_pointers{};  ///< the same, for the audio thread
};

/// What an update hands to the sound. Made and freed on the update thread; the audio thread reads.
struct Snapshot {
    std::uint64_t number = 0;
    std::int64_t frame = 0;  ///< at which its state was published
    std::vector<ListenerSnapshot> listeners{};
    bool was_heard = false;  ///< set by the audio thread before it gives the snapshot back
};

/// Snapshots on their way from the update thread to the audio thread and back, without locks. The
/// newest that was published counts: one that nobody has taken goes back to the update thread.
class SnapshotExchange {
public:
    /// Snapshots that exist at most; see SnapshotPlayer::kMaxPending.
    static constexpr std::size_t kCount = 10;

    /// Update thread: the snapshot that was published before and not taken, or null.
    std::unique_ptr<Snapshot> publish(std::unique_ptr<Snapshot> snapshot) noexcept {
        return std::unique_ptr<Snapshot>(
            published_.exchange(snapshot.release(), std::memory_order_acq_rel));
    }
    /// Update thread: a snapshot that the audio thread has given back, or null.
    std::unique_ptr<Snapshot> take_returned() noexcept {
        const std::size_t next = taken_;
        if (next == returned_.load(std::memory_order_acquire)) {
            return nullptr;
        }
        ++taken_;
        return std::unique_ptr<Snapshot>(ring_[next % kCount]);
    }

    /// Audio thread: the newest snapshot if there is one that it has not had.
    Snapshot* take() noexcept {
        if (published_.load(std::memory_order_relaxed) == nullptr) {
            return nullptr;
        }
        return published_.exchange(nullptr, std::memory_order_acq_rel);
    }
    /// Audio thread: gives a snapshot back. There is always room, as no more than kCount exist.
    void give_back(Snapshot* snapshot) noexcept {
        const std::size_t next = returned_.load(std::memory_order_relaxed);
        ring_[next % kCount] = snapshot;
        returned_.store(next + 1, std::memory_order_release);
    }

    /// After both threads have ended.
    ~SnapshotExchange() {
        while (take_returned() != nullptr) {
        }
        delete published_.load();
    }

private:
    std::atomic<Snapshot*> published_{nullptr};
    std::array<Snapshot*, kCount> ring_{};
    std::atomic<std::size_t> returned_{0};
    std::size_t taken_ = 0;
};

}  // namespace earshot::propagation
