// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_basis.h"
#include "earshot/base/floating_point.h"

#include <array>
#include <cstddef>
#include <memory>
#include <span>

namespace earshot::audio {

// The early sound of a listener while it plays: what a source sends out is filtered once by every
// filter of a basis and kept; each arrival is a weighted sum of these signals, read at its delay,
// at the level of the distance it has come, with a gain per channel
// (docs/algorithms/audio.md, "Arrivals in real time"). MovingArrivalRenderer is more exact and
// slower.

/// Samples by which arrivals are late, besides their delays.
inline constexpr std::size_t kArrivalLatency = 16;

/// What a source has sent out lately, through the filters of a basis.
class SourceLines {
public:
    struct Settings {
        std::size_t block = 256;        ///< samples of a call, a power of two of at least 16
        std::size_t max_delay = 48000;  ///< samples that can be read back
    };

    /// `basis` is not needed after this.
    SourceLines(const FilterBasis& basis, const Settings& settings);
    ~SourceLines();
    SourceLines(SourceLines&&) noexcept;
    SourceLines& operator=(SourceLines&&) noexcept;

    /// Takes the next block. Allocates nothing and takes no lock.
    void push(const float* signal) noexcept;

    struct State;
    const State& state() const noexcept { return *state_; }

private:
    std::unique_ptr<State> state_;
};

/// An arrival during one block.
struct MixedArrival {
    /// Samples since its emission at sample n of the block: coefficients of 1, n, n^2, n^3. Grows
    /// by less than a sample per sample.
    std::array<double, 4> delay{};
    /// Per filter of the basis, at 1 m: at sample 0, and change per sample.
    std::span<const float> weights{}, weight_steps{};
    /// Likewise per channel.
    std::span<const float> gains{}, gain_steps{};
};

/// Adds arrivals to the channels of one listener.
class ArrivalMixer {
public:
    /// `distance_per_sample`: metres that sound travels.
    ArrivalMixer(std::size_t block, double distance_per_sample);
    ~ArrivalMixer();
    ArrivalMixer(ArrivalMixer&&) noexcept;
    ArrivalMixer& operator=(ArrivalMixer&&) noexcept;

    /// Adds what arrives during the block that `lines` took last; rows of `out` are a block apart.
    /// Nearer than 1 mm the level is that of 1 mm. Where a delay is negative or longer than what is
    /// kept nothing is added, and false returned. Allocates nothing and takes no lock.
    bool add(const SourceLines& lines, const MixedArrival& arrival, float* out) noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::audio
