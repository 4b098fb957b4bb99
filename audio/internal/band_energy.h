// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/filter_cache_state.h"

#include <cstddef>
#include <span>
#include <vector>

namespace earshot::audio {

/// Splits a signal into bands by filters of zero phase: an impulse rings as much before its time as
/// after it, so no band is late against another.
class BandEnergy {
public:
    /// Precondition: signal not empty, sample_rate > 0; the cache outlives the object.
    BandEnergy(const Bands& bands,
               std::span<const double> signal,
               double sample_rate,
               const FilterCache& cache);

    /// False for a band that reaches past half the sample rate.
    bool covers(std::size_t band) const noexcept { return band < filters_->rows(); }

    /// The band's signal. Sample n of the signal is sample n + lead() here: the filters ring before
    /// its beginning and after its end. `memory`: a vector whose elements are not needed any more.
    /// Precondition: covers(band).
    std::vector<double> filtered(std::size_t band, std::vector<double> memory = {}) const;
    /// Its square per sample.
    std::vector<double> squared(std::size_t band, std::vector<double> memory = {}) const;
    std::size_t lead() const noexcept { return lead_; }

    /// Sum of squared() for a signal that is one sample of 1. Precondition: covers(band).
    double of_unit_impulse(std::size_t band) const;

private:
    std::span<const double> filter(std::size_t band) const;

    std::size_t lead_;
    std::size_t squared_size_;
    RecentlyUsed<BandFilters>::Loan filters_;
    WorkspacePool<FilterWorkspace>::Loan workspace_;
};

}  // namespace earshot::audio
