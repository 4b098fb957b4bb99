// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/internal/arrival_filter.h"
#include "earshot/audio/internal/representatives_kernel.h"
#include "earshot/base/large_array.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace earshot::audio {

/// What a filter may miss of its energy when it is made of others: -100 dB.
inline constexpr double kRepresentativeError = 1e-5;

/// The bins at which filters are compared: dense at low frequencies and at the band centres, where
/// spectra have kinks, else in a geometric series. They do not depend on a scene.
class FilterNodes {
public:
    explicit FilterNodes(const ArrivalFilter& filter);
    NodeRows rows() const noexcept;

private:
    std::size_t bands_;
    std::vector<std::uint32_t> lower_band_;
    std::vector<double> upper_weight_, weight_, phase_;
};

/// The logarithms of pressures, as Representatives::find() takes them: those of the bands in use,
/// relative to each spectrum's largest, which goes to `largest`. Precondition: no spectrum is
/// silent in these bands.
void log_pressures(std::span<const Spectrum* const> spectra,
                   std::size_t bands,
                   std::vector<double>& largest,
                   LargeArray<double>& logs);

/// Writes every filter of a set as a sum of a few of them, by Gram-Schmidt with the largest
/// remainder first (a rank-revealing QR decomposition, Golub and Van Loan 2013, section 5.4).
/// Keeps its memory between sets.
class Representatives {
public:
    /// `log_pressure`: groups of kLanes filters side by side, bands + 1 rows each (the last of
    /// zeros), of pressures relative to the filter's largest band; `count` filters in all. False if
    /// more than `max_pivots` would be needed; then the rest of this class has no meaning.
    bool find(const NodeRows& nodes,
              std::span<const double> log_pressure,
              std::size_t count,
              std::size_t max_pivots);

    /// The filters that stand for all, in the order in which they were chosen.
    std::span<const std::size_t> pivots() const noexcept { return pivots_; }
    /// A filter's factors of the pivots' filters.
    std::span<const double> weights(std::size_t filter) const noexcept {
        return std::span(weights_).subspan(filter * pivots_.size(), pivots_.size());
    }
    /// Filters that the sum misses by more than kRepresentativeError, ascending: normally none.
    std::span<const std::size_t> outside() const noexcept { return outside_; }

private:
    std::size_t groups() const noexcept { return sampled_.size(); }
    double* coefficients_of(std::size_t pivot, std::size_t group) noexcept {
        return &coefficients_[(pivot * groups() + group) * kLanes];
    }
    void make_vectors(const NodeRows& nodes,
                      std::span<const double> log_pressure,
                      std::size_t count);
    bool choose_pivots(std::size_t max_pivots);
    void add_pivot(std::size_t filter);
    bool extend_sample();
    void make_weights(std::size_t count);

    std::size_t size_ = 0;  // of a vector
    LargeArray<double> vectors_, norms_, remainders_;
    LargeArray<double> basis_;         // row per pivot
    LargeArray<double> coefficients_;  // row per pivot
    LargeArray<double> weights_, triangle_, column_;
    std::vector<char> sampled_;           // per group
    std::vector<std::size_t> projected_;  // per group, rows of the basis
    std::vector<std::size_t> pivots_, outside_;
    std::vector<const double*> sample_vectors_;
    std::vector<double*> sample_coefficients_, sample_remainders_;
};

}  // namespace earshot::audio
