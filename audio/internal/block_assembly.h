// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/arrival_impulses.h"
#include "earshot/audio/internal/assembly_tables.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Arrivals whose impulses begin within the samples of one block.
struct ArrivalBlock {
    std::ptrdiff_t begin = 0;  ///< of the block, in the response
    std::vector<std::size_t> arrivals;
};

/// One block of a response being assembled.
class BlockAssembly {
public:
    /// `fft`: of the size of a channel's sum, with room for every impulse of the block and the
    /// filters. The references have to outlive the object.
    BlockAssembly(const AssemblyTables& tables,
                  std::span<const Arrival> arrivals,
                  const ArrivalImpulses& impulses,
                  const RealFft& fft,
                  const ArrivalBlock& block,
                  BlockWorkspace& work);

    /// The block's part of every channel, from its begin on: a row of fft.size() samples each.
    void assemble(std::span<double> sums);

private:
    void sort_arrivals();
    std::size_t max_pivots() const;
    void add_represented();
    void spread_arrival(std::size_t arrival, double factor, std::span<const double> weights);
    void add_own(std::size_t filtered);
    void add_filtered_trains(std::size_t filtered, std::span<const double> trains);
    void add_piece(std::size_t filtered, double fraction, std::span<double> sums);
    void add_flat(std::size_t arrival, std::span<double> sums);
    void make_filter(std::size_t filtered, std::span<double> samples);
    void make_sums(std::span<double> sums);
    std::size_t offset_of(std::size_t arrival) const;
    double pressure_sign(std::size_t arrival) const;
    std::size_t stride() const noexcept { return padded(fft_.bins()); }

    const AssemblyTables& tables_;
    std::span<const Arrival> arrivals_;
    const ArrivalImpulses& impulses_;
    const RealFft& fft_;
    const ArrivalBlock& block_;
    BlockWorkspace& work_;
    std::size_t channels_;
    bool any_trains_ = false;
};

}  // namespace earshot::audio
