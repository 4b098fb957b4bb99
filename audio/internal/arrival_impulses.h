// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace earshot::audio {

/// The samples of a response that an arrival without a filter would set.
struct ImpulsePlace {
    std::ptrdiff_t begin = 0;  ///< may lie before sample 0
    std::size_t taps = 0;
};

/// What arrivals are in the channels of a response before their filters: impulses at their delays.
class ArrivalImpulses {
public:
    virtual ~ArrivalImpulses() = default;

    virtual std::size_t channels() const noexcept = 0;
    /// 1: the channels differ by factors only. Else: an impulse per channel.
    virtual std::size_t shapes() const noexcept = 0;
    virtual ImpulsePlace place(std::size_t arrival) const = 0;
    /// No impulse begins earlier, and none has more taps.
    virtual std::ptrdiff_t earliest() const noexcept = 0;
    virtual std::size_t max_taps() const noexcept = 0;
    /// The taps, a row of place().taps per shape.
    virtual void write(std::size_t arrival, std::span<double> taps) const = 0;
    virtual double gain(std::size_t arrival, std::size_t channel) const = 0;
    /// If the impulse is fractional_impulse(): of which fraction.
    virtual std::optional<double> fraction(std::size_t arrival) const = 0;
};

}  // namespace earshot::audio
