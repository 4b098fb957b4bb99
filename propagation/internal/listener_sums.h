// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/energy_histogram.h"
#include "earshot/propagation/internal/material_sums.h"
#include "earshot/propagation/internal/ray_tracer.h"
#include "earshot/propagation/internal/replicate_sums.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Share of energy that the air leaves, per bin of a histogram and band.
std::vector<double> air_losses(const RayOptions& options, std::size_t bins);

/// Adds up what one listener receives in batches of rays, in their order. Batches are replicates of
/// one experiment, so their spread tells the standard errors.
class ListenerSums {
public:
    /// `bins`, `direction_intervals` and the reported `materials` as in the results, in which the
    /// listener has number `listener`. `air_loss`: air_losses(), which all listeners share; it and
    /// the options must outlive the sums.
    ListenerSums(const RayOptions& options,
                 std::span<const double> air_loss,
                 std::size_t listener,
                 std::size_t bins,
                 std::size_t direction_intervals,
                 std::size_t materials);

    void add(const BatchResult& batch, std::size_t rays);

    std::size_t batches() const noexcept { return batches_; }
    /// Without EnergyHistogram::reflection_growth.
    audio::EnergyHistogram histogram() const;
    /// Of 500 Hz and 1 kHz, the larger error; of the late sound alone.
    LateErrors errors() const;
    audio::HistogramReplicates replicates() const { return replicates_.replicates(); }
    /// Precondition: materials are reported.
    LateMaterials materials() const { return materials_.result(); }

private:
    LateErrors errors_of(std::size_t band) const;
    double air_loss(std::size_t bin, std::size_t band) const {
        return air_loss_[bin * options_.bands.count() + band];
    }

    const RayOptions& options_;
    std::size_t listener_, bins_, direction_intervals_;
    std::span<const double> air_loss_;  // of energy, per bin and band
    std::vector<double> energy_, squares_,
        directions_;  // as in BatchResult, times the rays of a batch
    double rays_ = 0.0;
    std::size_t batches_ = 0;
    ReplicateSums replicates_;  // air included
    MaterialSums materials_;
};

}  // namespace earshot::propagation
