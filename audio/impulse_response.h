// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Sound arriving at a listener along one path.
struct Arrival {
    double delay = 0.0;                 ///< seconds since emission, not rounded to samples
    Spectrum pressure{};                ///< linear amplitude per band, >= 0; 1 = free field at 1 m
    std::array<double, 3> direction{};  ///< unit direction of travel at the listener
};

struct ResponseOptions {
    double sample_rate = 48000.0;  ///< hertz, 1000 ... 768000
    /// Seconds; 0: long enough for the last arrival and the ringing of its filter.
    double length = 0.0;
};

/// Pressure over time at one listener; sample 0 is the instant of emission.
struct ImpulseResponse {
    double sample_rate = 48000.0;
    std::vector<double> samples;
};

/// Adds every arrival as a band-limited impulse at its exact (fractional) delay, shaped by a
/// minimum-phase filter whose magnitude passes through the arrival's band pressures
/// (docs/algorithms/audio.md). Arrivals are added in the order given, so the sum has the same bits
/// on any machine. Arrivals past `length` are left out.
/// Throws Error if an option is out of range or the response would pass 2^31 samples.
ImpulseResponse assemble(const Bands& bands,
                         std::span<const Arrival> arrivals,
                         const ResponseOptions& options = {});

}  // namespace earshot::audio
