// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_bank.h"
#include "earshot/base/floating_point.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace earshot::audio {

// Arrivals whose delays and levels change while a signal plays (docs/algorithms/audio.md, "Moving
// arrivals"). A listener hears p(t) = s(t_e) / r, r = c (t - t_e): the signal at the instant t_e of
// emission, so that a changing delay is a Doppler shift, at the level of the distance r that the
// sound has come. What else changes its pressure (reflections, air, directivity) are weights of a
// few filters, which all arrivals share: each filter has a bus, a signal that arrivals are added
// to.

/// An arrival at an instant at which it is received.
struct MovingArrival {
    double delay = 0.0;               ///< seconds since its emission, >= 0
    double delay_rate = 0.0;          ///< change of the delay, seconds per second of reception, < 1
    std::span<const double> gains{};  ///< per bus, at 1 m
};

struct MovingArrivalScale {
    double sample_rate = 48000.0;   ///< hertz
    double speed_of_sound = 343.2;  ///< metres per second
};

/// Adds an arrival to the buses for `count` samples: row b of `buses`, `stride` apart, gets the
/// signal as it is heard. Between `from` (the first sample) and `to` (the one after the last) the
/// delay is the cubic with these values and rates, gains are linear. Nearer than 1 mm the level is
/// that of 1 mm. `now`: the place in `signal`
/// of what is emitted at the instant of the first sample; before and after the signal there is
/// silence. Where the delay is below kMovingArrivalLookahead samples, that many samples after `now`
/// + n are read for sample n. Allocates nothing. Preconditions: both have a gain per bus, count <=
/// kMaxArrivalStretch, stride >= count.
void add_moving_arrival(const MovingArrivalScale& scale,
                        std::span<const double> signal,
                        double now,
                        const MovingArrival& from,
                        const MovingArrival& to,
                        std::size_t count,
                        std::size_t stride,
                        double* buses) noexcept;

/// Samples after the instant of emission that interpolation reads.
inline constexpr std::size_t kMovingArrivalLookahead = 64;
inline constexpr std::size_t kMaxArrivalStretch = 256;

/// Moving arrivals of one signal, block by block, for a program that plays as it goes: the results
/// come kMovingArrivalLookahead samples late. begin_block(), add() for each arrival and stretch,
/// end_block() allocate nothing and take no lock. One object per signal and listener.
class MovingArrivalRenderer {
public:
    struct Settings {
        MovingArrivalScale scale{};
        double max_delay = 1.0;   ///< seconds; later arrivals are silent
        std::size_t block = 256;  ///< samples, a power of two of at least 4
        std::size_t channels = 1;
    };

    /// `filters` is not needed after this.
    MovingArrivalRenderer(const FilterBank& filters, const Settings& settings);
    ~MovingArrivalRenderer();
    MovingArrivalRenderer(MovingArrivalRenderer&&) noexcept;
    MovingArrivalRenderer& operator=(MovingArrivalRenderer&&) noexcept;

    /// One bus per filter and channel: bus filter * channels + channel.
    std::size_t buses() const noexcept;

    /// Takes the next block of the signal. Precondition: it is a block long.
    void begin_block(std::span<const double> signal) noexcept;
    /// Adds an arrival to samples `first` ... `first + count - 1` of the block, as
    /// add_moving_arrival().
    void add(const MovingArrival& from,
             const MovingArrival& to,
             std::size_t first,
             std::size_t count) noexcept;
    /// The block of every channel, one after the other. Precondition: out.size() == channels *
    /// block.
    void end_block(std::span<double> out) noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::audio
