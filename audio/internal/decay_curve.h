// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/decay_lines.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace earshot::audio {

/// The part of a decay that a reverberation time is read from, in decibels below its start.
struct DecayRange {
    const char* name = "";  ///< as in metrics.json
    int from_db = 0;
    int to_db = 0;
};

inline constexpr DecayRange kEarlyDecay{"edt", 0, 10};
inline constexpr DecayRange kT20{"t20", 5, 25};
inline constexpr DecayRange kT30{"t30", 5, 35};

/// Energy still to come, in decibels of the whole, by backward integration (Schroeder 1965; ISO
/// 3382-1:2009, 5.3.3).
class DecayCurve {
public:
    /// The curve begins at sample `onset`; its 0 dB is the energy of all samples, those before the
    /// onset included, and `tail_energy`, that of the decay after the last sample. Precondition: a
    /// sample is positive, onset < squared.size(). `memory`: a vector whose elements are not needed
    /// any more.
    DecayCurve(std::span<const double> squared,
               std::size_t onset,
               double sample_rate,
               double tail_energy = 0.0,
               std::vector<double> memory = {});
    /// The memory for another curve.
    std::vector<double> take_memory() && { return std::move(integral_); }

    double energy() const noexcept { return energy_; }
    /// Energy from `time` seconds after the onset on.
    double energy_from(double time) const noexcept;

    /// Of an energy, re the whole; nothing of none.
    std::optional<double> level_db(double energy) const noexcept;

    /// The straight line through the range by least squares, from the first sample in it to the
    /// one behind it, seconds after the onset; nothing if fewer than two samples are in it or the
    /// line does not fall.
    std::optional<DecayLine> line(const DecayRange& range) const;

    struct Reading {
        std::optional<double> time;  ///< for 60 dB, seconds
        bool ends_early = false;     ///< there is none because the response ends before its decay
        std::string why_not;         ///< where there is no time
    };
    /// Reverberation time from a straight line through the range by least squares, or why the curve
    /// does not support it (docs/algorithms/audio.md). `bandwidth_hz`: of the filter that the
    /// samples went through. `full_decay`: it is known that the decay was not cut off, so bends are
    /// its own.
    Reading read(const DecayRange& range, double bandwidth_hz, bool full_decay = false) const;

private:
    double slowness_after(int depth_db) const noexcept;
    double time_between(const DecayRange& range) const noexcept;
    double slope(const DecayRange& range) const noexcept;

    // The samples after the onset whose level is in the range.
    struct Samples {
        std::size_t begin = 0, end = 0;
    };
    Samples samples_in(const DecayRange& range) const noexcept;

    // Energy from each sample on, of the onset and those behind it.
    std::span<const double> remaining() const noexcept {
        return std::span(integral_).subspan(onset_);
    }

    double sample_rate_;
    std::size_t onset_;
    double energy_ = 0.0;
    int known_db_ = 0;                         // the curve is not known deeper
    std::vector<double> integral_;             // energy from each sample on
    std::vector<std::size_t> first_below_db_;  // entry d: first sample after the onset below -d dB
};

}  // namespace earshot::audio
