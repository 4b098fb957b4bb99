// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"
#include "earshot/audio/internal/arrival_filter.h"
#include "earshot/audio/internal/arrival_impulses.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/audio/internal/representatives.h"
#include "earshot/audio/internal/workspace_pool.h"
#include "earshot/base/large_array.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// What a thread needs to assemble a block; see block_assembly.cpp.
struct BlockWorkspace {
    std::vector<std::size_t> flat, filtered, own;
    std::vector<double> largest;  // pressure per filtered arrival
    LargeArray<double> logs;      // as Representatives::find() takes them
    Representatives representatives;
    LargeArray<double> log_pressure, log_magnitude, taps, weights, trains, piece;
    LargeArray<std::complex<double>> spectrum, filter, train, sum;
    FftWorkspace fft;
};

/// What depends on the bands and the sample rate alone.
struct AssemblyTables {
    AssemblyTables(const Bands& bands, double rate);

    /// No band in use has a pressure.
    bool silent(const Arrival& arrival) const;
    /// All bands in use have the same pressure.
    bool flat(const Arrival& arrival) const;

    double sample_rate;
    ArrivalFilter filter;
    FilterNodes nodes;
    DelayTable delays;
    RealFft piece_fft;  // of a filter and an impulse
    DelaySpectrum delay_spectrum;
    mutable WorkspacePool<BlockWorkspace> workspaces;
};

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

    /// `heard`: indices of arrivals, none of them silent. What lies outside the channels, which are
    /// equally long, is left out.
    void add(std::span<const std::size_t> heard,
             std::span<ImpulseResponse> channels,
             Executor& executor) const;

private:
    /// Arrivals whose impulses begin within `block_samples_` samples.
    struct Block {
        std::ptrdiff_t begin = 0;
        std::vector<std::size_t> arrivals;
    };

    std::vector<Block> blocks_of(std::span<const std::size_t> heard) const;
    void assemble(const Block& block, BlockWorkspace& work, std::span<double> sums) const;
    void sort_arrivals(const Block& block, BlockWorkspace& work) const;
    std::size_t max_pivots(std::size_t count, bool in_closed_form) const;
    void add_represented(const Block& block, BlockWorkspace& work) const;
    void spread_arrival(std::size_t arrival,
                        double factor,
                        std::span<const double> weights,
                        const Block& block,
                        BlockWorkspace& work) const;
    void add_own(std::size_t filtered, const Block& block, BlockWorkspace& work) const;
    void add_filtered_trains(std::size_t filtered,
                             std::span<const double> trains,
                             BlockWorkspace& work) const;
    void add_piece(std::size_t filtered,
                   double fraction,
                   const Block& block,
                   BlockWorkspace& work,
                   std::span<double> sums) const;
    void add_flat(std::size_t arrival,
                  const Block& block,
                  BlockWorkspace& work,
                  std::span<double> sums) const;
    void make_filter(std::size_t filtered, std::span<double> samples, BlockWorkspace& work) const;
    std::size_t offset_in(const Block& block, std::size_t arrival) const;
    double pressure_sign(std::size_t arrival) const;

    const AssemblyTables& tables_;
    std::span<const Arrival> arrivals_;
    const ArrivalImpulses& impulses_;
    RealFft fft_;  // of a block's sum
    std::size_t block_samples_;
};

}  // namespace earshot::audio
