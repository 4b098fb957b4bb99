// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/source_lines.h"
#include "earshot/propagation/engine/internal/snapshot.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::propagation {

/// From one instant to another, in frames.
struct Segment {
    std::int64_t begin = 0, end = 0;

    double length() const noexcept { return static_cast<double>(end - begin); }
};

/// The paths that a listener hears, each on its way from one snapshot to the next. Everything but
/// the constructor belongs to the audio thread.
class ListenerVoices {
public:
    ListenerVoices(std::size_t max_voices, std::size_t filters, std::size_t channels);

    /// Begins the way to a snapshot from wherever the voices are at segment.begin. Voices that it
    /// does not have fade out, new ones fade in. `late`: frames from the time for which the
    /// snapshot is meant to the segment's end: its delays are continued over these.
    void begin(const ListenerSnapshot& snapshot, const Segment& segment, double late) noexcept;
    /// Without a snapshot: delays go on at their rates, or come to rest until the segment's end.
    void hold(const Segment& segment, bool come_to_rest) noexcept;

    /// Adds what all voices bring to the block that begins at `frame`, within the segment.
    void add(std::int64_t frame,
             std::span<const audio::SourceLines> lines,
             audio::ArrivalMixer& mixer,
             float* channels) noexcept;

private:
    /// A delay and its rate, at both ends of the segment.
    struct Voice {
        std::uint64_t id = 0;
        std::uint32_t source = 0;
        bool is_active = false;
        bool is_wanted = false;  // by the snapshot on the way to which it is
        double delay[2] = {0.0, 0.0};
        double rate[2] = {0.0, 0.0};
    };

    void advance_to(std::int64_t frame) noexcept;
    void take(const SnapshotArrival& arrival,
              const float* weights,
              const float* gains,
              double late) noexcept;
    float* row(std::vector<float>& numbers, std::size_t slot, std::size_t size) noexcept {
        return &numbers[slot * size];
    }

    std::size_t filters_, channels_;
    Segment segment_;
    std::vector<Voice> voices_;          // per slot
    std::vector<std::uint32_t> active_;  // slots, `active_count_` of them
    std::size_t active_count_ = 0;
    std::vector<float> weights_[2], gains_[2];  // row per slot, at both ends of the segment
    std::vector<float> weights_now_, weight_steps_, gains_now_, gain_steps_;
};

}  // namespace earshot::propagation
