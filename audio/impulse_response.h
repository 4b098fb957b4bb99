// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/parallel.h"

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace earshot::audio {

/// Sound arriving at a listener along one path.
struct Arrival {
    double delay = 0.0;                 ///< seconds since emission, not rounded to samples
    Spectrum pressure{};                ///< linear amplitude per band, >= 0; 1 = free field at 1 m
    std::array<double, 3> direction{};  ///< unit direction of travel at the listener
    bool is_inverted = false;           ///< the pressure has the other sign
};

inline constexpr double kSilenceLength = 0.1;  ///< seconds

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

struct AssemblyTables;

/// Turns arrivals into impulse responses. What depends on the bands and the sample rate alone is
/// prepared once, and the memory that threads work in is kept. Const members may be called from
/// many threads at once.
class Assembler {
public:
    /// Throws Error if the sample rate is out of range.
    explicit Assembler(const Bands& bands, double sample_rate = 48000.0);
    ~Assembler();
    Assembler(Assembler&&) noexcept;
    Assembler& operator=(Assembler&&) noexcept;

    /// As the function below; `length` as in ResponseOptions.
    ImpulseResponse assemble(std::span<const Arrival> arrivals,
                             double length = 0.0,
                             Executor& executor = Executor::serial()) const;

    /// As assemble(), into several channels at once: `gains` has a row of `channels` factors of any
    /// sign per arrival. The channels share the filters and are equally long; the bits of each are
    /// those of assemble_channels() with its gains alone. Throws Error also if a gain is not
    /// finite. Precondition: gains.size() == arrivals.size() * channels.
    std::vector<ImpulseResponse> assemble_channels(std::span<const Arrival> arrivals,
                                                   std::span<const double> gains,
                                                   std::size_t channels,
                                                   double length = 0.0,
                                                   Executor& executor = Executor::serial()) const;

    /// What the other renderers of this folder share.
    const AssemblyTables& tables() const noexcept { return *tables_; }

private:
    std::unique_ptr<const AssemblyTables> tables_;
};

/// Adds every arrival as a band-limited impulse at its exact (fractional) delay, shaped by a
/// minimum-phase filter whose magnitude passes through the arrival's band pressures
/// (docs/algorithms/audio.md). Bands whose centre is not below half the sample rate are ignored.
/// Arrivals that come close in time share a few filters where there are many of them: what the sum
/// differs by from that of separately filtered arrivals is 100 dB below it. The sum has the same
/// bits on any machine and any number of threads. Arrivals past `length` are left out. Those
/// earlier than 64 samples have no room for the ringing ahead of an impulse and become the impulse
/// of an allpass filter, which has their pressure at all frequencies and their delay at all but the
/// highest. Silence is an answer: without arrivals the response is zeros, `length` long or
/// kSilenceLength if that is 0. Throws Error if an option is out of range, an arrival is not finite
/// or negative, or the response would pass 2^31 samples.
ImpulseResponse assemble(const Bands& bands,
                         std::span<const Arrival> arrivals,
                         const ResponseOptions& options = {},
                         Executor& executor = Executor::serial());

}  // namespace earshot::audio
