// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/partitioned_filter.h"
#include "earshot/base/floating_point.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace earshot::audio {

/// A long response of several channels, as TailConvolver plays it.
class Tail {
public:
    /// `channels`: the response of each; `block` as of the convolver.
    Tail(std::span<const std::vector<double>> channels, std::size_t block);

    std::size_t channels() const noexcept { return head_.size(); }
    const PartitionedFilter& head(std::size_t channel) const noexcept { return head_[channel]; }
    const PartitionedFilter& body(std::size_t channel) const noexcept { return body_[channel]; }

private:
    std::vector<PartitionedFilter> head_, body_;
};

/// The late sound of several sources at one listener, while it plays: uniform partitions of two
/// lengths (Gardner 1995). The first 16 blocks of a response are convolved block by block, the rest
/// in parts of eight blocks, whose work is spread evenly over the eight calls that follow.
/// Responses may be replaced: over a period of eight blocks the sound of the old ones fades into
/// that of the new ones. Allocates nothing after its constructor and takes no lock.
class TailConvolver {
public:
    struct Settings {
        std::size_t sources = 1;
        std::size_t channels = 1;
        std::size_t block = 256;         ///< a power of two of at least 4
        std::size_t max_length = 48000;  ///< of a response, samples; what is later is not heard
    };

    explicit TailConvolver(const Settings& settings);
    ~TailConvolver();
    TailConvolver(TailConvolver&&) noexcept;
    TailConvolver& operator=(TailConvolver&&) noexcept;

    static constexpr std::size_t kPeriod = 8;  ///< blocks

    /// Whether the next block begins a period: then and only then tails may be set.
    bool begins_period() const noexcept;
    /// One per source, null: silence. These are read until two periods after others were set.
    void set_tails(std::span<const Tail* const> tails) noexcept;

    /// `in`: a block per source, one after the other; adds to a block per channel of `out`.
    void process(const float* in, float* out) noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::audio
