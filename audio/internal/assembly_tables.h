// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"
#include "earshot/audio/internal/arrival_filter.h"
#include "earshot/audio/internal/fractional_delay.h"
#include "earshot/audio/internal/representatives.h"
#include "earshot/audio/internal/workspace_pool.h"
#include "earshot/base/large_array.h"

#include <complex>
#include <cstddef>
#include <vector>

namespace earshot::audio {

/// What a thread needs to assemble a block; see block_assembly.cpp.
struct BlockWorkspace {
    std::vector<std::size_t> flat, filtered, own;
    std::vector<const Spectrum*> pressures;  // per filtered arrival
    std::vector<double> largest;             // of each of them
    LargeArray<double> logs;                 // as Representatives::find() takes them
    Representatives representatives;
    LargeArray<double> log_pressure, log_magnitude, taps, weights, trains, piece;
    LargeArray<std::complex<double>> spectrum, filter, train, sum;
    FftWorkspace fft;
};

/// The size of the transforms in which impulses at any place of a block, their taps and a filter
/// find room, the block being at least a quarter of it.
std::size_t block_transform_size(std::size_t filter_size, std::size_t taps);

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
    const DelayTable& delays = DelayTable::shared();
    RealFft piece_fft;  // of a filter and an impulse
    RealFft block_fft;  // of a block of arrivals whose impulses have up to kAllpassTaps
    DelaySpectrum delay_spectrum;
    mutable WorkspacePool<BlockWorkspace> workspaces;
};

}  // namespace earshot::audio
