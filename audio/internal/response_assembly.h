// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/assembly_tables.h"
#include "earshot/audio/internal/block_assembly.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace earshot::audio {

/// Throws Error if a delay or a pressure is negative or not finite.
void check_arrivals(std::span<const Arrival> arrivals);

inline constexpr double kMaxSamples = 2147483648.0;  // 2^31

/// A number of samples that may be anything but NaN, as a whole one. Throws Error from kMaxSamples
/// on.
std::size_t checked_response_size(double samples);

/// Adds arrivals to the channels of a response: each is its impulse, filtered (docs/algorithms/
/// audio.md, "Blocks").
class ResponseAssembly {
public:
    /// The references have to outlive the object.
    ResponseAssembly(const AssemblyTables& tables,
                     std::span<const Arrival> arrivals,
                     const ArrivalImpulses& impulses);
    ResponseAssembly(const ResponseAssembly&) = delete;
    ResponseAssembly& operator=(const ResponseAssembly&) = delete;

    /// `heard`: indices of arrivals, none of them silent. What lies outside the channels, which are
    /// equally long, is left out.
    void add(std::span<const std::size_t> heard,
             std::span<ImpulseResponse> channels,
             Executor& executor) const;

private:
    std::vector<ArrivalBlock> blocks_of(std::span<const std::size_t> heard) const;

    const AssemblyTables& tables_;
    std::span<const Arrival> arrivals_;
    const ArrivalImpulses& impulses_;
    std::optional<RealFft> own_fft_;  // if that of the tables is too small
    const RealFft& fft_;              // of a block's sum
    std::size_t block_samples_;
};

}  // namespace earshot::audio
